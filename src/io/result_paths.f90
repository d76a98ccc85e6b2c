!> Where the results of a job go.
! allow(assumed-size)
module mpm_result_paths
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
  use mpm_error, only: error_t, exit_file, make_error
  implicit none
  private
  public :: result_paths_t, are_there_results, existing_results, make_folder, result_paths

  !> The files of a job.
  type :: result_paths_t
    character(:), allocatable :: log     !! JOB.log
    character(:), allocatable :: status  !! JOB.sta
    character(:), allocatable :: history !! JOB_history.csv
    character(:), allocatable :: points  !! JOB.vtkhdf
    character(:), allocatable :: mesh    !! JOB_mesh.vtkhdf
    character(:), allocatable :: restart !! JOB.restart.h5
    character(:), allocatable :: previous_restart !! JOB.restart.1.h5
    character(:), allocatable :: stop_request     !! JOB.stop, made by the user
    character(:), allocatable :: restart_request  !! JOB.restart, made by the user
    character(:), allocatable :: failure !! JOB_fail.vtkhdf, only of a run that failed
  end type result_paths_t

  interface
    !> Makes one folder; -1 when it is there already or cannot be made.
    function c_mkdir(path, mode) bind(c, name="mkdir") result(status)
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: mode
      integer(c_int) :: status
    end function c_mkdir
  end interface

contains

  !> Makes a folder and those above it. One that cannot be made is an error with its path; one
  !! that is there is fine.
  subroutine make_folder(folder, error)
    character(*), intent(in) :: folder               !! path, empty = current folder
    type(error_t), allocatable, intent(out) :: error !! exit_file
    integer, parameter :: mode = int(o"777")
    integer(c_int) :: status
    logical :: exists
    integer :: i

    if (len_trim(folder) == 0) return
    do i = 1, len_trim(folder)
      if (i < len_trim(folder) .and. folder(i:i) /= "/") cycle
      status = c_mkdir(folder(:i)//c_null_char, int(mode, c_int))
    end do
    inquire (file=trim(folder)//"/.", exist=exists)
    if (status == 0_c_int .or. exists) return
    call make_error(error, exit_file, "error: folder '"//trim(folder)//"' cannot be made: " &
                    //"expected a path where a folder may be written")
  end subroutine make_folder

  !> Paths of the files of a job.
  pure function result_paths(folder, job) result(paths)
    character(*), intent(in) :: folder !! where they go, empty = current folder
    character(*), intent(in) :: job    !! name of the job
    type(result_paths_t) :: paths
    character(:), allocatable :: stem

    stem = job
    if (len_trim(folder) > 0) then
      stem = trim(folder)//"/"//job
      if (folder(len_trim(folder):len_trim(folder)) == "/") stem = trim(folder)//job
    end if
    paths%log = stem//".log"
    paths%status = stem//".sta"
    paths%history = stem//"_history.csv"
    paths%points = stem//".vtkhdf"
    paths%mesh = stem//"_mesh.vtkhdf"
    paths%restart = stem//".restart.h5"
    paths%previous_restart = stem//".restart.1.h5"
    paths%stop_request = stem//".stop"
    paths%restart_request = stem//".restart"
    paths%failure = stem//"_fail.vtkhdf"
  end function result_paths

  !> Refuses to go on when a file of an earlier run is there.
  subroutine existing_results(paths, error)
    type(result_paths_t), intent(in) :: paths          !! files that a run would write
    type(error_t), allocatable, intent(out) :: error   !! exit_file with the first file found

    call refuse_results(paths, error)
    if (.not. allocated(error)) call refuse_existing(paths%restart, error)
  end subroutine existing_results

  !> Whether a file of an earlier run is there, restart files apart.
  logical function are_there_results(paths) result(found)
    type(result_paths_t), intent(in) :: paths !! files that a run would write
    type(error_t), allocatable :: error

    call refuse_results(paths, error)
    found = allocated(error)
  end function are_there_results

  !> Reports the first file of an earlier run, restart files apart.
  subroutine refuse_results(paths, error)
    type(result_paths_t), intent(in) :: paths        !! files that a run would write
    type(error_t), allocatable, intent(out) :: error !! exit_file if one is there

    call refuse_existing(paths%log, error)
    if (.not. allocated(error)) call refuse_existing(paths%status, error)
    if (.not. allocated(error)) call refuse_existing(paths%history, error)
    if (.not. allocated(error)) call refuse_existing(paths%points, error)
    if (.not. allocated(error)) call refuse_existing(paths%mesh, error)
    if (.not. allocated(error)) call refuse_existing(paths%failure, error)
  end subroutine refuse_results

  !> Reports a file that exists.
  subroutine refuse_existing(path, error)
    character(*), intent(in) :: path                 !! file
    type(error_t), allocatable, intent(out) :: error !! exit_file if the file is there
    logical :: exists

    inquire (file=path, exist=exists)
    if (.not. exists) return
    call make_error(error, exit_file, "error: '"//path//"' exists already: earlier results are " &
                    //"only overwritten with --force")
  end subroutine refuse_existing

end module mpm_result_paths
