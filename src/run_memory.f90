!> Memory of a run: whether there is enough before it begins, and whether it is allowed.
module mpm_run_memory
  use mpm_equilibrium, only: method_for
  use mpm_error, only: error_t, exit_solver, make_error
  use mpm_factor_estimate, only: factor_estimate
  use mpm_kinds, only: dp, ip
  use mpm_linear_method, only: method_recycled
  use mpm_material_points, only: bytes_of_points
  use mpm_memory, only: has_room, megabytes
  use mpm_model, only: model_t
  use mpm_run_estimate, only: expected_peak, memory_need_t, size_text
  use mpm_system, only: system_t
  use mpm_text, only: integer_text, real_text
  implicit none
  private
  public :: check_limit, check_memory, keeps_factors, memory_of_run

  integer, parameter :: copies = 2          !! of the mesh: as read, and as it moves
  real(dp), parameter :: program = 3.5e7_dp !! code and libraries of the smallest run [bytes]
  real(dp), parameter :: left_over = 1.08_dp !! with what was freed when the model was built
  real(dp), parameter :: gigabyte = 1.0e9_dp
  integer, parameter :: full_tensors = 2*9 + 4, sums = 6 + 36 + 1 !! reals of an element
  real(dp), parameter :: directions = 41.0_dp !! of GMRES, as many as are mostly in use

contains

  !> Room for the arrays over points and elements that a run adds to its model: more copies of
  !! points and mesh, kinematics and sums of the elements. The tangent is not among
  !! them: it says so itself when it does not fit.
  subroutine check_memory(model, max_memory, error)
    type(model_t), intent(in) :: model               !! complete
    real(dp), intent(in)      :: max_memory          !! allowed [GB], 0 = any
    type(error_t), allocatable, intent(out) :: error !! exit_solver
    type(memory_need_t) :: need
    integer(ip) :: n_bytes
    character(:), allocatable :: what

    need = memory_of_model(model)
    what = "a run with "//integer_text(model%points%n)//" material points and "// &
           integer_text(model%mesh%n_el)//" elements"
    n_bytes = bytes_to_come(model)
    if (.not. has_room(n_bytes)) then
      call make_error(error, exit_solver, "error: not enough memory for "//what//", about "// &
                      real_text(megabytes(real(n_bytes, dp)))//" MB more are needed: expected "// &
                      "a coarser mesh or fewer points per element")
    else if (is_above(expected_peak(need), max_memory)) then
      call refuse(error, expected_peak(need), max_memory, what//", without its equations,")
    end if
  end subroutine check_memory

  !> Memory that points and elements take beside the model itself.
  pure integer(ip) function bytes_to_come(model) result(n_bytes)
    type(model_t), intent(in) :: model
    integer :: gradients

    associate (n_dim => model%mesh%n_dim, n_el => model%mesh%n_el)
      gradients = n_dim*(n_dim + 1)
      n_bytes = 3_ip*bytes_of_points(model%points%n, n_dim) &
                + int(n_el, ip)*8*(2*(gradients + n_dim + 2) + full_tensors + gradients + sums)
    end associate
  end function bytes_to_come

  !> Refuses to go on when the run is expected to take more than is allowed.
  subroutine check_limit(error, system, model, max_memory)
    type(error_t), allocatable, intent(out) :: error !! exit_solver
    type(system_t), intent(in) :: system             !! its pattern has been analysed
    type(model_t), intent(in)  :: model
    real(dp), intent(in)       :: max_memory         !! allowed [GB], 0 = any
    real(dp) :: n_bytes

    if (max_memory <= 0.0_dp) return
    n_bytes = expected_peak(memory_of_run(system, model))
    if (is_above(n_bytes, max_memory)) then
      call refuse(error, n_bytes, max_memory, "the run with "//integer_text(model%points%n)// &
                  " material points and "//integer_text(system%dofs%n)//" equations")
    end if
  end subroutine check_limit

  !> Whether a limit is passed.
  pure function is_above(n_bytes, max_memory) result(above)
    real(dp), intent(in) :: n_bytes    !! needed [bytes]
    real(dp), intent(in) :: max_memory !! allowed [GB], 0 = any
    logical :: above

    above = max_memory > 0.0_dp .and. n_bytes > max_memory*gigabyte
  end function is_above

  !> Makes the error.
  pure subroutine refuse(error, n_bytes, max_memory, what)
    type(error_t), allocatable, intent(out) :: error !! exit_solver
    real(dp), intent(in)     :: n_bytes              !! needed [bytes]
    real(dp), intent(in)     :: max_memory           !! allowed [GB]
    character(*), intent(in) :: what                 !! that needs it

    call make_error(error, exit_solver, "error: "//what//" needs about "//size_text(n_bytes)// &
                    ", and --max-memory allows "//size_text(max_memory*gigabyte)//": expected "// &
                    "a higher limit, a coarser mesh, fewer points per element or smaller patches")
  end subroutine refuse

  !> Memory that the whole run is expected to take.
  pure function memory_of_run(system, model) result(need)
    type(system_t), intent(in) :: system !! its pattern has been analysed
    type(model_t), intent(in)  :: model
    type(memory_need_t) :: need

    need = memory_of_model(model)
    associate (map => system%map, tangent => system%tangent)
      need%pattern = 16.0_dp*real(tangent%nnz, dp) + 8.0_dp*real(tangent%n, dp)
      if (allocated(map%position)) then
        need%pattern = need%pattern + real(4*size(map%position, kind=ip), dp) &
                       + real(4*size(map%node), dp) + real(4*size(map%element_local), dp)
      end if
      if (keeps_factors(system, model)) then
        need%pattern = need%pattern + 8.0_dp*(real(tangent%nnz, dp) &
                                              + directions*real(tangent%n, dp))
      end if
      need%factors = factor_estimate(system%solver, real(tangent%nnz, dp))
    end associate
  end function memory_of_run

  !> Whether the first step keeps factors over corrections.
  pure logical function keeps_factors(system, model)
    type(system_t), intent(in) :: system !! its unknowns are numbered
    type(model_t), intent(in)  :: model

    keeps_factors = method_for(model%step(1)%newton, system%dofs%n) == method_recycled
  end function keeps_factors

  !> What points and mesh take, before anything is known of the equations.
  pure function memory_of_model(model) result(need)
    type(model_t), intent(in) :: model
    type(memory_need_t) :: need
    integer, parameter :: of_output = 120 ! bytes: a tensor field, as it is and as it is stored

    need%program = program
    associate (n => model%points%n, n_dim => model%mesh%n_dim, n_el => model%mesh%n_el)
      need%points = left_over*real(bytes_of_points(n, n_dim), dp)
      need%mesh = real(copies, dp)*bytes_of_mesh(model) &
                  + 8.0_dp*real(full_tensors + n_dim*(n_dim + 1) + sums, dp)*real(n_el, dp)
      need%mesh = left_over*need%mesh
      need%saving = real(of_output, dp)*real(n, dp)
    end associate
  end function memory_of_model

  !> One copy of the mesh and its patches.
  pure real(dp) function bytes_of_mesh(model) result(n_bytes)
    type(model_t), intent(in) :: model

    associate (n_dim => model%mesh%n_dim)
      n_bytes = real(model%mesh%n_el, dp)*real(8*n_dim*(n_dim + 1) + 8 + 8*(n_dim + 1) + 16, dp) &
                + real(model%mesh%n_node, dp)*real(8*n_dim + 4, dp)
    end associate
  end function bytes_of_mesh

end module mpm_run_memory
