/* Faults of libraries on demand, for LD_PRELOAD.
   UMFPACK: the calls of one function from number FAULT_FIRST on, FAULT_COUNT of them, go wrong.
   FAULT_CALL=symbolic or numeric: out of memory; solve: the first number of the solution is NaN.
   METIS: FAULT_CALL=order: out of memory; caught: what it answers after a SIGTERM.
   Memory: see malloc at the end. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define OUT_OF_MEMORY (-1L)
enum { METIS_OUT_OF_MEMORY = -3, METIS_CAUGHT = -4 };

typedef long (*symbolic_t)(long, long, const long *, const long *, const double *, void **,
                           const double *, double *);
typedef long (*numeric_t)(const long *, const long *, const double *, void *, void **,
                          const double *, double *);
typedef long (*solve_t)(long, const long *, const long *, const double *, double *, const double *,
                        void *, const double *, double *);

typedef int (*order_t)(int *, int *, int *, int *, int *, int *, int *);

static int is_due(const char *call)
{
    static long n_calls = 0;
    const char *wanted = getenv("FAULT_CALL"), *first = getenv("FAULT_FIRST"),
               *count = getenv("FAULT_COUNT");
    if (wanted == NULL || first == NULL || count == NULL || strcmp(wanted, call) != 0)
        return 0;
    n_calls++;
    return n_calls >= atol(first) && n_calls < atol(first) + atol(count);
}

long umfpack_dl_symbolic(long n_row, long n_col, const long *col_ptr, const long *row,
                         const double *val, void **symbolic, const double *control, double *info)
{
    symbolic_t original = (symbolic_t)dlsym(RTLD_NEXT, "umfpack_dl_symbolic");
    if (is_due("symbolic")) {
        *symbolic = NULL;
        return OUT_OF_MEMORY;
    }
    return original(n_row, n_col, col_ptr, row, val, symbolic, control, info);
}

long umfpack_dl_numeric(const long *col_ptr, const long *row, const double *val, void *symbolic,
                        void **numeric, const double *control, double *info)
{
    numeric_t original = (numeric_t)dlsym(RTLD_NEXT, "umfpack_dl_numeric");
    if (is_due("numeric")) {
        *numeric = NULL;
        return OUT_OF_MEMORY;
    }
    return original(col_ptr, row, val, symbolic, numeric, control, info);
}

long umfpack_dl_solve(long system, const long *col_ptr, const long *row, const double *val,
                      double *x, const double *rhs, void *numeric, const double *control,
                      double *info)
{
    solve_t original = (solve_t)dlsym(RTLD_NEXT, "umfpack_dl_solve");
    long status = original(system, col_ptr, row, val, x, rhs, numeric, control, info);
    if (is_due("solve"))
        x[0] = NAN;
    return status;
}

int METIS_NodeND(int *n, int *first, int *adjacent, int *weight, int *options, int *vertex,
                 int *place)
{
    order_t original = (order_t)dlsym(RTLD_NEXT, "METIS_NodeND");
    if (is_due("order"))
        return METIS_OUT_OF_MEMORY;
    if (is_due("caught"))
        return METIS_CAUGHT;
    return original(n, first, adjacent, weight, options, vertex, place);
}

/* Of the C library: what malloc does when nobody stands before it. */
extern void *__libc_malloc(size_t size);

/* FAULT_MALLOC: there are no blocks of this size and more. */
void *malloc(size_t size)
{
    const char *limit = getenv("FAULT_MALLOC");
    if (limit != NULL && size >= strtoul(limit, NULL, 10))
        return NULL;
    return __libc_malloc(size);
}
