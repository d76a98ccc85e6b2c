!> Interfaces of OpenBLAS, the library under UMFPACK; no logic.
! allow(assumed-size)
module mpm_openblas_binding
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int
  implicit none
  private
  public :: dgemm, dtrsm, openblas_set_num_threads

  interface

    !> Sets the number of threads of every later BLAS call of the process.
    subroutine openblas_set_num_threads(n_threads) bind(c, name="openblas_set_num_threads")
      import :: c_int
      implicit none
      integer(c_int), value :: n_threads !! at least 1
    end subroutine openblas_set_num_threads

    !> C = alpha A B + beta C.
    subroutine dgemm(transa, transb, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc) &
      bind(c, name="dgemm_")
      import :: c_char, c_double, c_int
      implicit none
      character(kind=c_char), intent(in) :: transa !! N: A as it is
      character(kind=c_char), intent(in) :: transb !! N: B as it is
      integer(c_int), intent(in) :: m              !! rows of A and C
      integer(c_int), intent(in) :: n              !! columns of B and C
      integer(c_int), intent(in) :: k              !! columns of A, rows of B
      real(c_double), intent(in) :: alpha          !! factor of A B
      integer(c_int), intent(in) :: lda            !! leading dimension of A
      real(c_double), intent(in) :: a(lda, *)      !! left factor
      integer(c_int), intent(in) :: ldb            !! leading dimension of B
      real(c_double), intent(in) :: b(ldb, *)      !! right factor
      real(c_double), intent(in) :: beta           !! factor of C
      integer(c_int), intent(in) :: ldc            !! leading dimension of C
      real(c_double), intent(inout) :: c(ldc, *)   !! the sum
    end subroutine dgemm

    !> Solves A X = alpha B with a triangular matrix A.
    subroutine dtrsm(side, uplo, transa, diag, m, n, alpha, a, lda, b, ldb) bind(c, name="dtrsm_")
      import :: c_char, c_double, c_int
      implicit none
      character(kind=c_char), intent(in) :: side   !! L: A stands to the left
      character(kind=c_char), intent(in) :: uplo   !! U: upper triangle
      character(kind=c_char), intent(in) :: transa !! N: as it is
      character(kind=c_char), intent(in) :: diag   !! N: with its diagonal
      integer(c_int), intent(in) :: m              !! rows of B
      integer(c_int), intent(in) :: n              !! columns of B
      real(c_double), intent(in) :: alpha          !! factor of B
      integer(c_int), intent(in) :: lda            !! leading dimension of A
      real(c_double), intent(in) :: a(lda, *)      !! triangle
      integer(c_int), intent(in) :: ldb            !! leading dimension of B
      real(c_double), intent(inout) :: b(ldb, *)   !! in B, out X
    end subroutine dtrsm

  end interface

end module mpm_openblas_binding
