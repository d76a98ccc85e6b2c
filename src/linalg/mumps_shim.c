/* A few calls of MUMPS behind plain arguments, and the same without MUMPS: then mumps_is_there
   tells so. No policy here; statuses are those of mumps_binding.f90. */
#include <stdlib.h>
#include <string.h>

enum { OK = 0, SINGULAR = 1, NO_MEMORY = 2 };

#ifdef TESSERA_MUMPS
#include <dmumps_c.h>

#define ICNTL(i) icntl[(i) - 1]
#define INFOG(i) infog[(i) - 1]
#define RINFOG(i) rinfog[(i) - 1]

enum { INITIALISE = -1, END = -2, ANALYSE = 1, FACTORIZE = 2, SOLVE = 3 };
enum { METIS = 5, MOST_ROOM = 1000, USE_COMM_WORLD = -987654 };

static int status_of(const DMUMPS_STRUC_C *id)
{
    switch (id->INFOG(1)) {
    case -5: case -7: case -8: case -9: case -11: case -13: case -14: case -15: case -17: case -19:
    case -20: case -51:
        return NO_MEMORY;
    default:
        return id->INFOG(1) < 0 ? SINGULAR : OK;
    }
}

static void call(DMUMPS_STRUC_C *id, int job)
{
    id->job = job;
    dmumps_c(id);
}

int tessera_mumps_is_there(void)
{
    return 1;
}

void tessera_mumps_close(void *handle)
{
    DMUMPS_STRUC_C *id = handle;
    if (id == NULL)
        return;
    call(id, END);
    free(id->irn);
    free(id->jcn);
    free(id);
}

/* Analyses a pattern of compressed columns, indices from 0; NULL when that fails. */
void *tessera_mumps_analyse(int n, long nnz, const long *col_ptr, const long *row, int *status,
                            double *bytes)
{
    DMUMPS_STRUC_C *id = calloc(1, sizeof *id);
    *status = NO_MEMORY;
    if (id == NULL)
        return NULL;
    id->sym = 0;
    id->par = 1;
    id->comm_fortran = USE_COMM_WORLD;
    call(id, INITIALISE);
    for (int stream = 1; stream <= 4; stream++)
        id->ICNTL(stream) = 0;  /* no output */
    id->ICNTL(6) = 0;           /* the diagonal stays where it is */
    id->ICNTL(7) = METIS;
    id->ICNTL(10) = 0;          /* no refinement */
    id->ICNTL(24) = 1;          /* zero pivots are counted */
    id->n = n;
    id->nnz = nnz;
    id->irn = malloc((size_t)nnz * sizeof *id->irn);
    id->jcn = malloc((size_t)nnz * sizeof *id->jcn);
    if (id->irn != NULL && id->jcn != NULL) {
        for (int j = 0; j < n; j++)
            for (long k = col_ptr[j]; k < col_ptr[j + 1]; k++) {
                id->irn[k] = (MUMPS_INT)row[k] + 1;
                id->jcn[k] = j + 1;
            }
        call(id, ANALYSE);
        *status = status_of(id);
    }
    *bytes = 1.0e6 * (id->INFOG(16) > 0 ? id->INFOG(16) : 1); /* whole megabytes */
    if (*status == OK)
        return id;
    tessera_mumps_close(id);
    return NULL;
}

/* Factorises values in the order of the pattern; rcond is smallest over largest pivot. */
int tessera_mumps_factorize(void *handle, double *val, double *rcond)
{
    DMUMPS_STRUC_C *id = handle;
    int status;
    id->a = val;
    do {
        call(id, FACTORIZE);
        /* -8 and -9: pivoting needs more room than foreseen */
        if (id->INFOG(1) != -8 && id->INFOG(1) != -9)
            break;
        id->ICNTL(14) *= 2;
    } while (id->ICNTL(14) <= MOST_ROOM);
    id->a = NULL;
    status = status_of(id);
    *rcond = 0.0;
    if (status == OK && id->INFOG(28) > 0)
        status = SINGULAR;
    if (status == OK && id->RINFOG(20) > 0.0)
        *rcond = id->RINFOG(19) / id->RINFOG(20);
    return status;
}

/* Solves with the factors; x holds the right-hand side before. */
int tessera_mumps_solve(void *handle, double *x)
{
    DMUMPS_STRUC_C *id = handle;
    id->rhs = x;
    call(id, SOLVE);
    id->rhs = NULL;
    return status_of(id);
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

void *tessera_mumps_analyse(int n, long nnz, const long *col_ptr, const long *row, int *status,
                            double *bytes)
{
    (void)n, (void)nnz, (void)col_ptr, (void)row;
    *status = NO_MEMORY;
    *bytes = 0.0;
    return NULL;
}

int tessera_mumps_factorize(void *handle, double *val, double *rcond)
{
    (void)handle, (void)val;
    *rcond = 0.0;
    return SINGULAR;
}

int tessera_mumps_solve(void *handle, double *x)
{
    (void)handle, (void)x;
    return SINGULAR;
}

#endif
