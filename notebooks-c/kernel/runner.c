/* SPDX-License-Identifier: MIT */
/* The process in which a notebook's cells run. It reads lines "OBJECT ENTRY" on stdin, loads the shared object and
   calls the entry. On the descriptor given as argument it answers "show PATH" while a cell runs (and waits for a line
   on stdin, so that the picture comes in its place), and "done MESSAGE" after it, "done ok" when all went well. */
#include "nb.h"
#include <dlfcn.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <sys/wait.h>

enum { FAILED = -1 };

static FILE *answers;
static sigjmp_buf after_failure;
static volatile sig_atomic_t in_cell;
static char message[1024] = "ok";

static void caught(int number) {
  if (in_cell) siglongjmp(after_failure, number);
  signal(number, SIG_DFL);
  raise(number);
}

static void catch_signals(void) {
  static const int numbers[] = {SIGSEGV, SIGFPE, SIGBUS, SIGILL, SIGABRT, SIGINT};
  static char stack[1 << 16]; /* a cell may have overflown its own */
  sigaltstack(&(stack_t){.ss_sp = stack, .ss_size = sizeof stack}, NULL);
  struct sigaction action = {.sa_handler = caught, .sa_flags = SA_ONSTACK | SA_NODEFER};
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) sigaction(numbers[i], &action, NULL);
}

void nb_show(const char *path) {
  fflush(NULL);
  fprintf(answers, "show %s\n", path);
  fflush(answers);
  while (getchar() != '\n') continue;
}

void nb_fail(const char *format, ...) {
  va_list list;
  va_start(list, format);
  vsnprintf(message, sizeof message, format, list);
  va_end(list);
  for (char *c = message; *c; c++)
    if (*c == '\n') *c = ' ';
  siglongjmp(after_failure, FAILED);
}

void nb_run(const char *format, ...) {
  char command[4096];
  va_list list;
  va_start(list, format);
  vsnprintf(command, sizeof command, format, list);
  va_end(list);
  printf("$ %s\n", command);
  fflush(NULL);
  int status = system(command);
  if (status != 0) nb_fail("%s: exit status %d", command, WIFEXITED(status) ? WEXITSTATUS(status) : status);
}

static void call(const char *object, const char *entry) {
  snprintf(message, sizeof message, "ok");
  void *handle = dlopen(object, RTLD_NOW | RTLD_GLOBAL);
  if (!handle) {
    snprintf(message, sizeof message, "%s", dlerror());
    return;
  }
  void (*cell)(void);
  *(void **)&cell = dlsym(handle, entry);
  int failure = sigsetjmp(after_failure, 1);
  in_cell = !failure;
  if (!failure) cell();
  in_cell = 0;
  if (failure > 0) snprintf(message, sizeof message, "%s", strsignal(failure));
}

int main(int argc, char **argv) {
  char line[8192], object[4096], entry[128];
  answers = argc == 2 ? fdopen(atoi(argv[1]), "w") : NULL;
  if (!answers) return 2;
  catch_signals();
  while (fgets(line, sizeof line, stdin)) {
    if (sscanf(line, "%4095s %127s", object, entry) != 2) continue;
    call(object, entry);
    fflush(NULL);
    fprintf(answers, "done %s\n", message);
    fflush(answers);
  }
  return 0;
}
