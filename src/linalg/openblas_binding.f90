!> C interface of OpenBLAS, the library under UMFPACK; no logic.
module mpm_openblas_binding
  use, intrinsic :: iso_c_binding, only: c_int
  implicit none
  private
  public :: openblas_set_num_threads

  interface

    !> Sets the number of threads of every later BLAS call of the process.
    subroutine openblas_set_num_threads(n_threads) bind(c, name="openblas_set_num_threads")
      import :: c_int
      implicit none
      integer(c_int), value :: n_threads !! at least 1
    end subroutine openblas_set_num_threads

  end interface

end module mpm_openblas_binding
