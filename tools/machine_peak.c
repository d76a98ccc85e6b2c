/* What one thread of this machine can do: fused multiply-adds in registers, and STREAM's triad.
 * By CPU time, as the update is measured too; the best of several rounds, since other work on the
 * machine can only make a round slower. */
#define _POSIX_C_SOURCE 200112L
#include <stdlib.h>
#include <time.h>

#if defined(__AVX512F__)
#define WIDTH 8
#elif defined(__AVX__)
#define WIDTH 4
#else
#define WIDTH 2
#endif
#define CHAINS 12 /* independent sums: more than the latency of an operation times its rate */
#define ROUNDS 12

typedef double vector_t __attribute__((vector_size(8 * WIDTH)));

/* CPU time of this thread [s]. */
static double now(void)
{
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The chains are variables of their own, so that each stays in its register. */
static double sum_of_chains(long n, double factor, double addend)
{
  vector_t a = factor + (vector_t){0}, b = addend + (vector_t){0};
  /* Different from each other, or the compiler would keep one for all. */
  vector_t c0 = b, c1 = 2 * b, c2 = 3 * b, c3 = 4 * b, c4 = 5 * b, c5 = 6 * b, c6 = 7 * b;
  vector_t c7 = 8 * b, c8 = 9 * b, c9 = 10 * b, c10 = 11 * b, c11 = 12 * b, total;
  double sum = 0.0;

  for (long i = 0; i < n; i++) {
    c0 = c0 * a + b;
    c1 = c1 * a + b;
    c2 = c2 * a + b;
    c3 = c3 * a + b;
    c4 = c4 * a + b;
    c5 = c5 * a + b;
    c6 = c6 * a + b;
    c7 = c7 * a + b;
    c8 = c8 * a + b;
    c9 = c9 * a + b;
    c10 = c10 * a + b;
    c11 = c11 * a + b;
  }
  total = c0 + c1 + c2 + c3 + c4 + c5 + c6 + c7 + c8 + c9 + c10 + c11;
  for (int k = 0; k < WIDTH; k++)
    sum += total[k];
  return sum;
}

/* Double precision, an addition and a multiplication counted as two [GFLOP/s]. */
double peak_gflops(void)
{
  const long n = 10000000;
  volatile double factor = 0.999, result;
  double best = 0.0;

  for (int i = 0; i < ROUNDS; i++) {
    double start = now();
    result = sum_of_chains(n, factor, 1e-3);
    double rate = 2.0 * WIDTH * CHAINS * (double)n / (now() - start) * 1e-9;
    if (rate > best)
      best = rate;
  }
  (void)result;
  return best;
}

/* a = b + s c over three arrays of n numbers, 24 bytes each as STREAM counts them [GB/s];
 * 0 without memory. */
double triad_gbytes(long n)
{
  double *a = malloc(8 * n), *b = malloc(8 * n), *c = malloc(8 * n);
  volatile double scale = 3.0, sink;
  double best = 0.0;

  if (a && b && c) {
    for (long i = 0; i < n; i++) {
      a[i] = 0.0;
      b[i] = (double)i;
      c[i] = 1.0;
    }
    for (int round = 0; round < ROUNDS; round++) {
      double s = scale, start = now();
      for (long i = 0; i < n; i++)
        a[i] = b[i] + s * c[i];
      double rate = 24.0 * (double)n / (now() - start) * 1e-9;
      sink = a[n / 2];
      if (rate > best)
        best = rate;
    }
    (void)sink;
  }
  free(a);
  free(b);
  free(c);
  return best;
}
