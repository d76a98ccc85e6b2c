!> A small model with all that the writers look at, and a reader of what they wrote.
module result_samples
  use mpm_dof_map, only: constraint_t
  use mpm_kinds, only: dp
  use mpm_material, only: law_von_mises
  use mpm_material_points, only: points_t, status_frozen, status_inside
  use mpm_mesh, only: face_set_t, index_set_t, mesh_t
  use mpm_model, only: expectation_t, history_of_point, history_request_t, model_t
  use mpm_patches, only: patches_t
  use mpm_run_state, only: make_run_state, run_info_t, run_state_t
  implicit none
  private
  public :: line_of_file, make_sample_info, make_sample_model, make_sample_state, number_of_lines

contains

  !> Two tetrahedra on a common face, one patch each, three points, the last without a host.
  subroutine make_sample_model(model)
    type(model_t), intent(out) :: model

    model%job = "sample"
    model%heading = "two tetrahedra"
    model%unit_length = "m"
    model%unit_force = "kN"
    model%patch_source = "METIS"
    call make_sample_mesh(model%mesh)
    model%patches = patches_t(2, [1, 2], [1, 2, 3], [1, 2])
    call make_sample_points(model%points)
    allocate (model%material(1))
    model%material(1)%name = "CLAY"
    model%material(1)%law = law_von_mises
    model%material(1)%density = 2.0_dp
    model%material(1)%young = 1.0e4_dp
    model%material(1)%poisson = 0.48_dp
    model%material(1)%yield_stress = [0.85_dp]
    model%material(1)%plastic_strain = [0.0_dp]
    allocate (model%amplitude(0))
    allocate (model%step(1))
    call make_sample_step(model)
  end subroutine make_sample_model

  !> Nodes at the origin, on the axes and at (1, 1, 1).
  subroutine make_sample_mesh(mesh)
    type(mesh_t), intent(out) :: mesh

    mesh%n_dim = 3
    mesh%n_node = 5
    mesh%n_el = 2
    allocate (mesh%x(3, 5), source=0.0_dp)
    mesh%x(1, 2) = 1.0_dp
    mesh%x(2, 3) = 1.0_dp
    mesh%x(3, 4) = 1.0_dp
    mesh%x(:, 5) = 1.0_dp
    mesh%node = reshape([1, 2, 3, 4, 2, 3, 4, 5], [4, 2])
    mesh%volume = [1.0_dp/6.0_dp, 1.0_dp/3.0_dp]
    allocate (mesh%node_set(2), mesh%element_set(1), mesh%surface(1))
    mesh%node_set(1) = index_set_t("BASE", [1, 2, 3])
    mesh%node_set(2) = index_set_t("TOP", [4, 5])
    mesh%element_set(1) = index_set_t("SOIL", [1, 2])
    mesh%surface(1) = face_set_t("SKIN", [1], [4])
  end subroutine make_sample_mesh

  !> Stress and strain differ in every component and point.
  subroutine make_sample_points(points)
    type(points_t), intent(out) :: points
    integer :: i

    points%n = 3
    allocate (points%x(3, 3), points%u(3, 3), points%def_grad(3, 3, 3))
    points%x = reshape([(0.1_dp*i, i=1, 9)], [3, 3])
    points%u = reshape([(0.01_dp*i, i=1, 9)], [3, 3])
    points%def_grad = 0.0_dp
    do i = 1, 3
      points%def_grad(i, i, :) = 1.0_dp
    end do
    points%def_grad(1, 2, 2) = 0.5_dp
    points%def_grad(3, 3, 2) = 2.0_dp
    points%id = [1, 2, 3]
    points%place = points%id
    points%element = [1, 2, 0]
    points%material = [1, 1, 1]
    points%status = [status_inside, status_inside, status_frozen]
    points%volume_0 = [1.0_dp, 2.0_dp, 3.0_dp]
    points%volume = [1.5_dp, 2.5_dp, 4.0_dp]
    points%mass = [2.0_dp, 4.0_dp, 6.0_dp]
    points%state%cauchy = reshape([(real(i, dp), i=1, 18)], [6, 3])
    points%state%strain_e = reshape([(0.001_dp*i, i=1, 18)], [6, 3])
    points%state%hardening = reshape([0.1_dp, 0.2_dp, 0.3_dp], [1, 3])
    points%state%jacobian_bar = [1.0_dp, 2.0_dp, 3.0_dp]
  end subroutine make_sample_points

  !> TOP goes down by 0.25 in a step of length 2.
  subroutine make_sample_step(model)
    type(model_t), intent(inout) :: model

    associate (step => model%step(1))
      step%name = "PUSH"
      step%schedule%period = 2.0_dp
      allocate (step%constraint(2), step%load(0), step%history(2), step%expectation(2))
      step%constraint(1) = constraint_t([1, 2, 3], 3)
      step%constraint(2) = constraint_t([4, 5], 3, -0.25_dp)
      step%history(1) = history_request_t(label="TOP", node=[4, 5], &
                                          quantity=[character(8) :: "RF", "U"])
      step%history(2) = history_request_t(history_of_point, "0.4,0.5,0.6", point=2, &
                                          quantity=[character(8) :: "S", "PEEQ"])
      allocate (step%history(2)%node(0))
      step%expectation(1) = expectation_t("RF", "TOP", [4, 5], 3, 2.0_dp, "SUM", .false., &
                                          -9.0_dp, 0.1_dp, origin="sample.inp:31")
      step%expectation(2) = expectation_t("PEEQ", "", time=1.0_dp, statistic="MAX", &
                                          value=0.3_dp, atol=0.01_dp)
    end associate
  end subroutine make_sample_step

  !> The state after an increment that ends at a time: nodal values grow with the time.
  subroutine make_sample_state(state, increment, time)
    type(run_state_t), intent(out) :: state
    integer, intent(in) :: increment
    real(dp), intent(in) :: time
    integer :: i

    call make_run_state(state, 3, 5, 2, 2)
    state%step = min(1, increment)
    state%increment = increment
    state%increment_total = increment
    state%attempt = 1
    state%time = time
    state%step_time = time
    state%size = 1.0_dp
    state%n_iterations = 4
    state%residual = 1.0e-11_dp
    state%wall_seconds = 3.0_dp
    state%n_active_elements = 2
    state%n_lost = 1
    state%reaction(3, :) = [(time*i, i=1, 3), -2.0_dp*time, -4.0_dp*time]
    state%applied(1, :) = time
    state%node_u = reshape([(time*i, i=1, 15)], [3, 5])
    state%delta_u = 0.5_dp*state%node_u
    state%delta_j = [1.1_dp, 0.9_dp]
    state%delta_j_patch = [1.2_dp, 0.8_dp]
  end subroutine make_sample_state

  !> A program and a deck of two lines.
  subroutine make_sample_info(info)
    type(run_info_t), intent(out) :: info

    info%deck_name = "sample.inp"
    info%deck_text = "*HEADING"//new_line("a")//"two tetrahedra"
    info%warnings = ""
    info%formulation = "fbar"
    info%version = "1.2.3"
    info%git = "abcdef"
    info%compiler = "GNU 12"
    info%libraries = "HDF5 1.10"
    info%started = "2024-02-03T04:05:06+01:00"
    info%run_id = "20240203T040506.789+0100-42"
    info%n_threads = 2
    info%quiet = .true.
  end subroutine make_sample_info

  !> Lines of a text file.
  integer function number_of_lines(path)
    character(*), intent(in) :: path
    integer :: status, unit

    number_of_lines = 0
    open (newunit=unit, file=path, status="old", action="read", iostat=status)
    do while (status == 0)
      read (unit, "(a)", iostat=status)
      if (status == 0) number_of_lines = number_of_lines + 1
    end do
    close (unit, iostat=status)
  end function number_of_lines

  !> One line of a text file, empty beyond its end.
  function line_of_file(path, number) result(line)
    character(*), intent(in) :: path
    integer, intent(in) :: number !! from 1
    character(:), allocatable :: line
    character(400) :: buffer
    integer :: i, status, unit

    buffer = ""
    open (newunit=unit, file=path, status="old", action="read", iostat=status)
    do i = 1, number
      if (status == 0) read (unit, "(a)", iostat=status) buffer
    end do
    if (status /= 0) buffer = ""
    close (unit, iostat=status)
    line = trim(buffer)
  end function line_of_file

end module result_samples
