/* SPDX-License-Identifier: MIT */
/* Decimal text to double and back: exact, fast, and the same in every locale. */
#ifndef SKF_CORE_NUMBER_H
#define SKF_CORE_NUMBER_H

#include "skelfield/core.h"

enum { SKF_NUMBER_SIZE = 32 };

/* Reads [+-] digits [. digits] [(e|E) [+-] digits] at the start of the text, correctly rounded; ".5" and "5." are
   numbers, "inf", "nan" and "0x1" are not. *used is the count of characters that belong to the number. SKF_ERR_PARSE
   when there is none, SKF_ERR_RANGE when it overflows a double. The text ends with a character that is not part of a
   number, such as NUL. */
skf_status skf_number_read(const char *text, size_t *used, double *out);

/* Writes x as printf's "%.17g" does in the C locale, with NUL, and "nan" whatever its sign; returns the length. */
size_t skf_number_write(char text[SKF_NUMBER_SIZE], double x);

#endif
