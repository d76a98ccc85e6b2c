!> One-patch cases of an independent implementation, and random ones, for the tests of assembly.
module patch_cases
  use mpm_ghost_penalty, only: build_ghost
  use mpm_kinds, only: dp
  use mpm_material, only: law_elastic, law_von_mises
  use mpm_material_points, only: n_hardening
  use mpm_patches, only: patches_t
  use mpm_simplex, only: simplex_gradients
  use mpm_sparsity, only: build_pattern
  use mpm_system, only: body_t, find_active, open_system, system_t
  implicit none
  private
  public :: case_t, read_cases, prepare, single_elements

  !> A case: the body, the displacement, and what must come out.
  type :: case_t
    type(body_t) :: body
    real(dp), allocatable :: u(:, :)       !! (n_dim, n_node)
    real(dp), allocatable :: kirchhoff(:, :) !! (6, n_point)
    real(dp), allocatable :: cg_e(:, :)    !! (6, n_point)  b_e
    real(dp), allocatable :: volume(:)     !! (n_point)
    integer, allocatable  :: plastic(:)    !! (n_point)  1 = flows
    real(dp), allocatable :: f_int(:, :)   !! (n_dim, n_node)
    real(dp), allocatable :: tangent(:, :) !! (n_eq, n_eq)
  end type case_t

contains

  !> Reads all cases of the file that the build made from tests/data/unit_patch.json.
  subroutine read_cases(cases)
    type(case_t), allocatable, intent(out) :: cases(:)
    integer :: unit, i, n_case

    open (newunit=unit, file="unit_patch.txt", action="read", status="old")
    read (unit, *) n_case
    allocate (cases(n_case))
    do i = 1, n_case
      call read_case(unit, cases(i))
    end do
    close (unit)
  end subroutine read_cases

  !> Reads the next case.
  subroutine read_case(unit, problem)
    integer, intent(in) :: unit
    type(case_t), intent(out) :: problem
    integer :: n_dim, method, n_node, n_el, n_point
    real(dp) :: young, poisson, yield
    real(dp), allocatable :: cg(:, :)

    read (unit, *) n_dim, method, n_node, n_el, n_point
    read (unit, *) young, poisson, yield
    call set_material(problem%body, young, poisson, yield)
    associate (mesh => problem%body%mesh, points => problem%body%points)
      mesh%n_dim = n_dim
      mesh%n_node = n_node
      mesh%n_el = n_el
      allocate (mesh%x(n_dim, n_node), mesh%node(n_dim + 1, n_el))
      read (unit, *) mesh%x
      read (unit, *) mesh%node
      points%n = n_point
      allocate (points%element(n_point), points%volume(n_point), points%state%jacobian_bar(n_point))
      allocate (cg(6, n_point))
      read (unit, *) points%element
      read (unit, *) points%volume
      read (unit, *) cg
      read (unit, *) points%state%jacobian_bar
      cg(1:3, :) = cg(1:3, :) - 1.0_dp
      points%state%left_cauchy_green_e_m1 = cg
    end associate
    allocate (problem%u(n_dim, n_node), problem%kirchhoff(6, n_point), problem%cg_e(6, n_point))
    allocate (problem%volume(n_point), problem%plastic(n_point), problem%f_int(n_dim, n_node))
    allocate (problem%tangent(n_dim*n_node, n_dim*n_node))
    read (unit, *) problem%u
    read (unit, *) problem%kirchhoff
    read (unit, *) problem%cg_e
    read (unit, *) problem%volume
    read (unit, *) problem%plastic
    read (unit, *) problem%f_int
    read (unit, *) problem%tangent
    problem%tangent = transpose(problem%tangent)
    call finish_body(problem%body, method == 1)
  end subroutine read_case

  !> The strength of the cases is the uniaxial measure sqrt(3 J2).
  subroutine set_material(body, young, poisson, yield)
    type(body_t), intent(inout) :: body
    real(dp), intent(in) :: young, poisson, yield

    allocate (body%material(1))
    body%material(1)%name = "CASE"
    body%material(1)%young = young
    body%material(1)%poisson = poisson
    body%material(1)%law = law_elastic
    if (yield <= 0.0_dp) return
    body%material(1)%law = law_von_mises
    body%material(1)%yield_stress = [yield]
    body%material(1)%plastic_strain = [0.0_dp]
  end subroutine set_material

  !> Geometry, patches and grouping of the points.
  subroutine finish_body(body, is_standard)
    type(body_t), intent(inout) :: body
    logical, intent(in) :: is_standard !! every element its own patch
    integer :: e, p, n

    associate (mesh => body%mesh, points => body%points)
      n = points%n
      allocate (mesh%grad_shape(mesh%n_dim, mesh%n_dim + 1, mesh%n_el), mesh%volume(mesh%n_el))
      do e = 1, mesh%n_el
        call simplex_gradients(mesh%x(:, mesh%node(:, e)), mesh%grad_shape(:, :, e), mesh%volume(e))
      end do
      body%patches = single_elements(mesh%n_el)
      if (.not. is_standard) body%patches = one_patch(mesh%n_el)
      allocate (points%material(n), source=1)
      points%id = [(p, p=1, n)]
      points%place = points%id
      allocate (points%u(mesh%n_dim, n), points%shape(mesh%n_dim + 1, n), source=0.0_dp)
      if (.not. allocated(points%x)) allocate (points%x, source=points%u)
      if (.not. allocated(points%def_grad)) allocate (points%def_grad(3, 3, n), source=0.0_dp)
      allocate (points%state%strain_e(6, n), points%state%cauchy(6, n), source=0.0_dp)
      allocate (points%state%hardening(n_hardening, n), source=0.0_dp)
      allocate (points%first(mesh%n_el + 1))
      allocate (points%order(0))
      points%first(1) = 1
      do e = 1, mesh%n_el
        points%order = [points%order, pack([(p, p=1, n)], points%element == e)]
        points%first(e + 1) = size(points%order) + 1
      end do
    end associate
  end subroutine finish_body

  !> All elements in one patch.
  pure function one_patch(n_el) result(patches)
    integer, intent(in) :: n_el
    type(patches_t) :: patches
    integer :: e

    patches%n = 1
    patches%of_element = [(1, e=1, n_el)]
    patches%first = [1, n_el + 1]
    patches%element = [(e, e=1, n_el)]
  end function one_patch

  !> Every element its own patch.
  pure function single_elements(n_el) result(patches)
    integer, intent(in) :: n_el
    type(patches_t) :: patches
    integer :: e

    patches%n = n_el
    patches%of_element = [(e, e=1, n_el)]
    patches%first = [(e, e=1, n_el + 1)]
    patches%element = [(e, e=1, n_el)]
  end function single_elements

  !> A system without constraints on the body: every node of an active element is free.
  subroutine prepare(system, body)
    type(system_t), intent(out) :: system
    type(body_t), intent(in) :: body
    integer :: a, i, e

    call open_system(system, body)
    call find_active(system, body%points)
    associate (dofs => system%dofs, mesh => body%mesh)
      allocate (dofs%active(mesh%n_node), source=.false.)
      do e = 1, mesh%n_el
        if (system%active(e)) dofs%active(mesh%node(:, e)) = .true.
      end do
      allocate (dofs%fixed(mesh%n_dim, mesh%n_node), source=.false.)
      allocate (dofs%prescribed(mesh%n_dim, mesh%n_node), source=0.0_dp)
      allocate (dofs%id(mesh%n_dim, mesh%n_node), source=0)
      do a = 1, mesh%n_node
        if (.not. dofs%active(a)) cycle
        dofs%id(:, a) = [(dofs%n + i, i=1, mesh%n_dim)]
        dofs%n = dofs%n + mesh%n_dim
      end do
    end associate
    if (body%ghost_gamma > 0.0_dp) then
      call build_ghost(system%ghost, body%ghost_gamma, body%mesh, body%points, body%material, &
                       system%active)
    end if
    call build_pattern(system%tangent, system%map, body%patches, body%mesh, system%dofs, &
                       system%active, system%ghost%node)
  end subroutine prepare

end module patch_cases
