/* SPDX-License-Identifier: MIT */
/* Modules: shared objects with costly libraries behind them, opened only when they are needed. */
#ifndef SKF_ADAPT_MODULE_H
#define SKF_ADAPT_MODULE_H

/* The address of `symbol` in the module `file`, which stays open; NULL with the reason, one line, in error. The module
   is looked for in the folders of $SKELFIELD_MODULES (separated by colons), beside the program, in the build's and in
   the installed folder. */
const void *skf_module_symbol(const char *file, const char *symbol, char error[256]);

#endif
