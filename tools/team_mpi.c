/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The module that talks MPI. It waits without keeping a core busy, and the first process not for ever: once a signal
   has come, a process that does not answer is lost, and what is done can still be written. */
#include "team.h"
#include <stdlib.h>
#include <time.h>

#include <mpi.h>

enum { DATA, STOP };
/* Bytes of one message: MPI counts in int. */
#define PIECE ((size_t)1 << 30)

typedef struct mpi {
  int rank, size;
  const team_hooks *hooks;
  bool cried, lost;
  int heard;          /* processes that have cried in this round */
  MPI_Request *cries; /* to each of the others */
  double patience;    /* seconds after a signal */
  double limit;       /* at any time; 0: none */
} mpi;

static double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Open MPI's mpirun kills what has not ended a second after it was told to, unless it is told otherwise. */
static double patience(void) {
  const char *text = getenv("OMPI_MCA_odls_base_sigkill_timeout");
  double s = text ? strtod(text, NULL) : 1;
  return 0.6 * (s > 0 ? s : 1);
}

static void *join(int *rank, int *size, const team_hooks *hooks) {
  int level;
  mpi *m = calloc(1, sizeof *m);
  if (!m || MPI_Init_thread(NULL, NULL, MPI_THREAD_SERIALIZED, &level) != MPI_SUCCESS) return free(m), NULL;
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  MPI_Comm_rank(MPI_COMM_WORLD, &m->rank);
  MPI_Comm_size(MPI_COMM_WORLD, &m->size);
  m->hooks = hooks, m->patience = patience();
  m->cries = malloc((size_t)m->size * sizeof *m->cries);
  if (!m->cries || level < MPI_THREAD_SERIALIZED) return MPI_Finalize(), free(m->cries), free(m), NULL;
  *rank = m->rank, *size = m->size;
  return m;
}

static void cry(mpi *m) {
  if (m->cried) return;
  m->cried = true;
  for (int k = 0; k < m->size; k++) {
    m->cries[k] = MPI_REQUEST_NULL;
    if (k != m->rank) MPI_Isend(NULL, 0, MPI_BYTE, k, STOP, MPI_COMM_WORLD, m->cries + k);
  }
}

/* Whether a message has come that another process cried. */
static bool hear(mpi *m) {
  int here = 0;
  if (MPI_Iprobe(MPI_ANY_SOURCE, STOP, MPI_COMM_WORLD, &here, MPI_STATUS_IGNORE) != MPI_SUCCESS || !here) return false;
  MPI_Recv(NULL, 0, MPI_BYTE, MPI_ANY_SOURCE, STOP, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  return m->heard++, true;
}

static bool poll(void *self, bool stop) {
  mpi *m = self;
  if (stop) cry(m);
  hear(m);
  return m->cried || m->heard > 0;
}

/* Every process that has cried has sent one message to each: those that nobody has asked for are taken now. */
static void calm(void *self) {
  mpi *m = self;
  int cried = m->cried, all = 0;
  if (MPI_Allreduce(&cried, &all, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD) != MPI_SUCCESS) return;
  while (m->heard < all - cried) hear(m);
  if (cried) MPI_Waitall(m->size, m->cries, MPI_STATUSES_IGNORE);
  m->cried = false, m->heard = 0;
}

static void rest(unsigned turn) {
  long ns = turn < 20 ? 50000 : 1000000;
  nanosleep(&(struct timespec){0, ns}, NULL);
}

static skf_status finish(mpi *m, int begun, MPI_Request *request) {
  enum { SPINS = 1000 };
  double since = 0, start = m->limit > 0 ? seconds() : 0;
  if (begun != MPI_SUCCESS) m->lost = true;
  for (unsigned turn = 0; !m->lost; turn++) {
    int done = 0;
    if (MPI_Test(request, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS) m->lost = true;
    if (done && !m->lost) return SKF_OK;
    if (turn < SPINS) continue;
    rest(turn - SPINS);
    if (m->limit > 0 && seconds() - start > m->limit) m->lost = true;
    if (m->hooks->stop(m->hooks->user)) cry(m);
    if (m->rank > 0 || !m->hooks->interrupted()) continue;
    if (since == 0) since = seconds();
    if (seconds() - since > m->patience) m->lost = true;
  }
  return SKF_ERR_CANCELLED;
}

static skf_status send(void *self, size_t to, const void *bytes, size_t n) {
  mpi *m = self;
  skf_status s = m->lost ? SKF_ERR_CANCELLED : SKF_OK;
  for (const char *p = bytes; n > 0 && !s;) {
    size_t k = n < PIECE ? n : PIECE;
    MPI_Request request;
    int begun = MPI_Isend(p, (int)k, MPI_BYTE, (int)to, DATA, MPI_COMM_WORLD, &request);
    s = finish(m, begun, &request);
    p += k, n -= k;
  }
  return s;
}

static skf_status receive(void *self, size_t from, void *bytes, size_t n) {
  mpi *m = self;
  skf_status s = m->lost ? SKF_ERR_CANCELLED : SKF_OK;
  for (char *p = bytes; n > 0 && !s;) {
    size_t k = n < PIECE ? n : PIECE;
    MPI_Request request;
    int begun = MPI_Irecv(p, (int)k, MPI_BYTE, (int)from, DATA, MPI_COMM_WORLD, &request);
    s = finish(m, begun, &request);
    p += k, n -= k;
  }
  return s;
}

static bool lost(const void *self) { return ((const mpi *)self)->lost; }

static void hurry(void *self, double limit) {
  mpi *m = self;
  m->limit = limit;
  if (limit <= 0) m->lost = true;
}

static void leave(void *self) {
  mpi *m = self;
  if (!m->lost) MPI_Finalize(); /* which waits for the others */
  free(m->cries);
  free(m);
}

/* Found by this name in the module. */
extern const team_module team_module_mpi;
const team_module team_module_mpi = {join, send, receive, poll, calm, lost, hurry, leave};
