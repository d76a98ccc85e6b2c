!> A box of material points before the stress update of an increment, for bench_kernel.
module kernel_body
  use mpm_constitutive_update, only: element_sums_t
  use mpm_error, only: error_t
  use mpm_kinds, only: dp
  use mpm_kinematics, only: allocate_kinematics, kinematics_t
  use mpm_material, only: law_von_mises, material_t
  use mpm_material_points, only: generate_points, points_t
  use mpm_mesh, only: mesh_t
  use mpm_mesh_generator, only: box_settings_t, generate_box, graded_planes
  use mpm_parent_mesh, only: parent_mesh_t
  use mpm_parent_split, only: split_parents
  use mpm_stress_update, only: point_response_t, update_stress
  use mpm_tensor, only: det_m1
  implicit none
  private
  public :: body_t, make_body, update_by_point

  integer, parameter :: n_per_element = 11      !! points of a tetrahedron
  real(dp), parameter :: stretch = 1.0e-3_dp    !! largest entry of an increment of F [-]

  !> What a stress update reads.
  type :: body_t
    type(mesh_t)   :: mesh
    type(points_t) :: points                      !! state after a first increment
    type(kinematics_t) :: kinematics              !! of the next one, the same in direction
    type(material_t), allocatable :: material(:)  !! (1)
    integer, allocatable :: element(:)            !! (n_el)  all of them
  end type body_t

contains

  !> A cube of clay after a random increment that is repeated: points that flow go on flowing.
  subroutine make_body(body, n_cells, strength)
    type(body_t), intent(out) :: body !! complete
    integer, intent(in)  :: n_cells   !! along an edge, six tetrahedra each
    real(dp), intent(in) :: strength  !! sqrt(3 J2) at yield [force/length^2]
    type(point_response_t) :: response
    type(error_t), allocatable :: error
    integer :: e, p

    call make_mesh(body%mesh, n_cells)
    body%element = [(e, e=1, body%mesh%n_el)]
    allocate (body%material(1))
    body%material(1)%law = law_von_mises
    body%material(1)%young = 1.0e4_dp
    body%material(1)%poisson = 0.48_dp
    body%material(1)%yield_stress = [strength]
    body%material(1)%plastic_strain = [0.0_dp]
    call generate_points(body%points, body%mesh, body%element, 1, n_per_element, 1.0_dp, error)
    call must_work(error)
    call allocate_kinematics(body%kinematics, body%mesh)
    do e = 1, body%mesh%n_el
      call draw(body%kinematics%disp_grad_bar(:, :, e), e)
      body%kinematics%delta_j_bar_m1(e) = det_m1(body%kinematics%disp_grad_bar(:, :, e))
    end do
    do p = 1, body%points%n
      call update_stress(response, body%material(1), &
                         body%kinematics%disp_grad_bar(:, :, body%points%element(p)), &
                         body%points%state%left_cauchy_green_e_m1(:, p), 0.0_dp)
      body%points%state%left_cauchy_green_e_m1(:, p) = response%left_cauchy_green_e_m1
      body%points%state%hardening(1, p) = response%plastic_strain
    end do
  end subroutine make_body

  !> Linear tetrahedra with edges of one.
  subroutine make_mesh(mesh, n_cells)
    type(mesh_t), intent(out) :: mesh !! complete
    integer, intent(in) :: n_cells    !! along an edge
    type(parent_mesh_t)  :: parent
    type(box_settings_t) :: box
    type(error_t), allocatable :: error

    box%x = graded_planes(0.0_dp, real(n_cells, dp), n_cells, 1.0_dp)
    box%y = box%x
    box%z = box%x
    call generate_box(parent, box, error)
    call must_work(error)
    call split_parents(parent, mesh, error)
    call must_work(error)
  end subroutine make_mesh

  !> Entries between plus and minus `stretch`, the same ones in every run.
  pure subroutine draw(disp_grad, e)
    real(dp), intent(out) :: disp_grad(3, 3) !! H [-]
    integer, intent(in)   :: e               !! element
    integer :: i, j

    do j = 1, 3
      do i = 1, 3
        disp_grad(i, j) = stretch*sin(real(e, dp)*(1.3_dp + real(i, dp) + 3.7_dp*real(j, dp)))
      end do
    end do
  end subroutine draw

  !> The stress update of all points with the checked update of one, element by element.
  subroutine update_by_point(sums, body)
    type(element_sums_t), intent(inout) :: sums  !! stress, moduli, points that flow
    type(body_t), intent(in) :: body             !! converged state, increment
    type(point_response_t) :: response
    real(dp) :: factor
    integer :: e, i, n_plastic, p

    n_plastic = 0
    associate (points => body%points, kinematics => body%kinematics)
      !$omp parallel do default(shared) schedule(static) private(response, factor, i, p) &
      !$omp reduction(+: n_plastic)
      do e = 1, body%mesh%n_el
        sums%stress(:, e) = 0.0_dp
        sums%moduli(:, :, e) = 0.0_dp
        do i = points%first(e), points%first(e + 1) - 1
          p = points%order(i)
          call update_stress(response, body%material(points%material(p)), &
                             kinematics%disp_grad_bar(:, :, e), &
                             points%state%left_cauchy_green_e_m1(:, p), &
                             points%state%hardening(1, p))
          if (response%flows) n_plastic = n_plastic + 1
          factor = points%volume(p)/points%state%jacobian_bar(p)
          sums%stress(:, e) = sums%stress(:, e) + factor*response%kirchhoff
          sums%moduli(:, :, e) = sums%moduli(:, :, e) + factor*response%moduli
        end do
      end do
      !$omp end parallel do
    end associate
    sums%n_plastic = n_plastic
  end subroutine update_by_point

  !> Ends the program when the body could not be made.
  subroutine must_work(error)
    type(error_t), allocatable, intent(in) :: error !! unallocated if all is well

    if (.not. allocated(error)) return
    write (*, "(a)") "bench_kernel: "//error%message
    stop 1
  end subroutine must_work

end module kernel_body
