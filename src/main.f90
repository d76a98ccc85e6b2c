!> tessera JOB.inp: material point analysis on simplex meshes with F-bar patches.
program tessera
  use, intrinsic :: iso_c_binding, only: c_int
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
  use mpm_command_line, only: command_line_t, get_arguments, help_text, read_command_line, version_text
  use mpm_error, only: error_t, exit_ok
  use mpm_memory, only: keep_freed_memory
  use mpm_run_job, only: run_job
  use mpm_schema_json, only: schema_json
  use mpm_schema_markdown, only: schema_markdown
  use omp_lib, only: omp_get_max_threads, omp_set_num_threads
  implicit none

  interface
    !> Ends the process: a Fortran 2008 stop code must be constant, and error stop prints a backtrace.
    subroutine c_exit(code) bind(c, name="exit")
      import :: c_int
      integer(c_int), value :: code
    end subroutine c_exit
  end interface

  type(command_line_t) :: options
  type(error_t), allocatable :: error
  character(:), allocatable :: arguments(:)
  integer :: exit_code
  logical :: keeps

  exit_code = exit_ok
  call get_arguments(arguments)
  call read_command_line(options, arguments, error)
  if (.not. allocated(error)) then
    if (options%help) then
      write (output_unit, "(a)") help_text()
    else if (options%version) then
      write (output_unit, "(a)") version_text()
    else if (options%schema) then
      write (output_unit, "(a)") schema_json()
    else if (options%schema_markdown) then
      write (output_unit, "(a)") schema_markdown()
    else
      keeps = keep_freed_memory() ! where not, it only takes longer
      if (options%threads > 0) call omp_set_num_threads(options%threads)
      options%threads = omp_get_max_threads()
      call run_job(exit_code, options, error)
    end if
  end if
  if (allocated(error)) then
    write (error_unit, "(a)") error%message
    exit_code = error%code
  end if
  flush (output_unit)
  flush (error_unit)
  call c_exit(int(exit_code, c_int))
end program tessera
