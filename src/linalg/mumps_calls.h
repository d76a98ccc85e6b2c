/* The calls of mumps_shim.c in one precision. Included once for each, with these defined:
     REAL    type of the factors
     STRUC   structure of MUMPS
     MUMPS   its procedure
     NAME(x) name of a function in this precision */

static int NAME(status)(const STRUC *id)
{
    switch (id->INFOG(1)) {
    case -5: case -7: case -8: case -9: case -11: case -13: case -14: case -15: case -17: case -19:
    case -20: case -51:
        return NO_MEMORY;
    default:
        return id->INFOG(1) < 0 ? SINGULAR : OK;
    }
}

static void NAME(call)(STRUC *id, int job)
{
    id->job = job;
    MUMPS(id);
}

static void NAME(close)(STRUC *id)
{
    NAME(call)(id, END);
    free(id->irn);
    free(id->jcn);
    free(id);
}

static STRUC *NAME(analyse)(int n, long nnz, const long *col_ptr, const long *row,
                            const int *place, int *status, double *found)
{
    STRUC *id = calloc(1, sizeof *id);
    *status = NO_MEMORY;
    if (id == NULL)
        return NULL;
    id->sym = 0;
    id->par = 1;
    id->comm_fortran = USE_COMM_WORLD;
    NAME(call)(id, INITIALISE);
    if (id->INFOG(1) < 0) {
        free(id);
        return NULL;
    }
    for (int stream = 1; stream <= 4; stream++)
        id->ICNTL(stream) = 0;  /* no output */
    id->ICNTL(6) = 0;           /* the diagonal stays where it is */
    id->ICNTL(7) = GIVEN;
    id->perm_in = (MUMPS_INT *)place; /* read only */
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
        NAME(call)(id, ANALYSE);
        *status = NAME(status)(id);
    }
    id->perm_in = NULL;
    found[BYTES] = 1.0e6 * (id->INFOG(16) > 0 ? id->INFOG(16) : 1); /* whole megabytes */
    found[ENTRIES] = count_of(id->INFOG(20));
    found[FLOPS] = id->RINFOG(1);
    if (*status == OK)
        return id;
    NAME(close)(id);
    return NULL;
}

/* Values are divided by a power of two before, so that those of any unit fit. */
static int NAME(factorize)(STRUC *id, const double *val, double scale, double *rcond,
                           double *found)
{
    REAL *a = malloc((size_t)id->nnz * sizeof *a);
    int status;
    *rcond = 0.0;
    if (a == NULL)
        return NO_MEMORY;
    for (MUMPS_INT8 k = 0; k < id->nnz; k++)
        a[k] = (REAL)(val[k] / scale);
    id->a = a;
    do {
        NAME(call)(id, FACTORIZE);
        /* -8 and -9: pivoting needs more room than foreseen */
        if (id->INFOG(1) != -8 && id->INFOG(1) != -9)
            break;
        id->ICNTL(14) *= 2;
    } while (id->ICNTL(14) <= MOST_ROOM);
    id->a = NULL;
    free(a);
    status = NAME(status)(id);
    if (status == OK && id->INFOG(28) > 0)
        status = SINGULAR;
    if (status == OK && id->RINFOG(LARGEST_PIVOT) > 0)
        *rcond = id->RINFOG(SMALLEST_PIVOT) / id->RINFOG(LARGEST_PIVOT);
    found[BYTES] = 1.0e6 * id->INFOG(21); /* whole megabytes */
    found[ENTRIES] = count_of(id->INFOG(29));
    found[FLOPS] = id->RINFOG(3);
    return status;
}

static int NAME(solve)(STRUC *id, double scale_of_matrix, double *x)
{
    const double scale = power_above(id->n, x);
    REAL *rhs = malloc((size_t)id->n * sizeof *rhs);
    if (rhs == NULL)
        return NO_MEMORY;
    for (MUMPS_INT i = 0; i < id->n; i++)
        rhs[i] = (REAL)(x[i] / scale);
    id->rhs = rhs;
    NAME(call)(id, SOLVE);
    id->rhs = NULL;
    for (MUMPS_INT i = 0; i < id->n; i++)
        x[i] = (double)rhs[i] * (scale / scale_of_matrix);
    free(rhs);
    return NAME(status)(id);
}

#undef REAL
#undef STRUC
#undef MUMPS
#undef NAME
