/* A few calls of MUMPS, in double and in single precision, behind plain arguments, and the same
   without MUMPS: then mumps_is_there tells so. No policy here; statuses are those of
   mumps_binding.f90. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { OK = 0, SINGULAR = 1, NO_MEMORY = 2 };
enum { BYTES = 0, ENTRIES = 1, FLOPS = 2, N_FOUND = 3 }; /* what a call tells */

#ifdef TESSERA_MUMPS
#include <dmumps_c.h>
#include <smumps_c.h>

#define ICNTL(i) icntl[(i) - 1]
#define INFOG(i) infog[(i) - 1]
#define RINFOG(i) rinfog[(i) - 1]

enum { INITIALISE = -1, END = -2, ANALYSE = 1, FACTORIZE = 2, SOLVE = 3 };
enum { GIVEN = 1, MOST_ROOM = 1000, USE_COMM_WORLD = -987654 };
_Static_assert(sizeof(MUMPS_INT) == sizeof(int), "a MUMPS with indices of 32 bits");
enum { SMALLEST_PIVOT = 19, LARGEST_PIVOT = 21 };

/* MUMPS tells large counts as negative millions. */
static double count_of(int told)
{
    return told < 0 ? -1.0e6 * told : told;
}

/* The power of two above all values; 1 for zeros. */
static double power_above(long n, const double *value)
{
    double largest = 0.0;
    int exponent;
    for (long i = 0; i < n; i++)
        largest = fmax(largest, fabs(value[i]));
    if (!(largest > 0.0) || !isfinite(largest))
        return 1.0;
    frexp(largest, &exponent);
    return ldexp(1.0, exponent < 1000 ? exponent : 1000);
}

#define REAL double
#define STRUC DMUMPS_STRUC_C
#define MUMPS dmumps_c
#define NAME(x) double_##x
#include "mumps_calls.h"

#define REAL float
#define STRUC SMUMPS_STRUC_C
#define MUMPS smumps_c
#define NAME(x) single_##x
#include "mumps_calls.h"

/* One of the two, and the scale of the matrix that was factorised. */
typedef struct {
    DMUMPS_STRUC_C *in_double;
    SMUMPS_STRUC_C *in_single;
    double scale;
} solver_t;

int tessera_mumps_is_there(void)
{
    return 1;
}

void tessera_mumps_close(void *handle)
{
    solver_t *solver = handle;
    if (solver == NULL)
        return;
    if (solver->in_double != NULL)
        double_close(solver->in_double);
    if (solver->in_single != NULL)
        single_close(solver->in_single);
    free(solver);
}

/* Analyses a pattern of compressed columns, indices from 0, with the place of each column in the
   order of elimination, from 1; NULL when that fails. */
void *tessera_mumps_analyse(int single, int n, long nnz, const long *col_ptr, const long *row,
                            const int *place, int *status, double *found)
{
    solver_t *solver = calloc(1, sizeof *solver);
    memset(found, 0, N_FOUND * sizeof *found);
    *status = NO_MEMORY;
    if (solver == NULL)
        return NULL;
    if (single)
        solver->in_single = single_analyse(n, nnz, col_ptr, row, place, status, found);
    else
        solver->in_double = double_analyse(n, nnz, col_ptr, row, place, status, found);
    if (*status == OK)
        return solver;
    free(solver);
    return NULL;
}

/* Factorises values in the order of the pattern; rcond is smallest over largest pivot. */
int tessera_mumps_factorize(void *handle, const double *val, double *rcond, double *found)
{
    solver_t *solver = handle;
    if (solver->in_double != NULL) {
        solver->scale = power_above(solver->in_double->nnz, val);
        return double_factorize(solver->in_double, val, solver->scale, rcond, found);
    }
    solver->scale = power_above(solver->in_single->nnz, val);
    return single_factorize(solver->in_single, val, solver->scale, rcond, found);
}

/* Solves with the factors; x holds the right-hand side before. */
int tessera_mumps_solve(void *handle, double *x)
{
    solver_t *solver = handle;
    if (solver->in_double != NULL)
        return double_solve(solver->in_double, solver->scale, x);
    return single_solve(solver->in_single, solver->scale, x);
}

#else

int tessera_mumps_is_there(void)
{
    return 0;
}

void tessera_mumps_close(void *handle)
{
    (void)handle;
}

void *tessera_mumps_analyse(int single, int n, long nnz, const long *col_ptr, const long *row,
                            const int *place, int *status, double *found)
{
    (void)single, (void)n, (void)nnz, (void)col_ptr, (void)row, (void)place;
    memset(found, 0, N_FOUND * sizeof *found);
    *status = NO_MEMORY;
    return NULL;
}

int tessera_mumps_factorize(void *handle, const double *val, double *rcond, double *found)
{
    (void)handle, (void)val;
    memset(found, 0, N_FOUND * sizeof *found);
    *rcond = 0.0;
    return SINGULAR;
}

int tessera_mumps_solve(void *handle, double *x)
{
    (void)handle, (void)x;
    return SINGULAR;
}

#endif
