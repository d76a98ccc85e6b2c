!> Internal force and tangent from the element sums, element by element and patch by patch.
module mpm_assembly
  use mpm_constitutive_update, only: element_sums_t
  use mpm_csc_matrix, only: csc_matrix_t
  use mpm_kinds, only: dp, ip
  use mpm_kinematics, only: kinematics_t
  use mpm_mesh, only: mesh_t
  use mpm_patches, only: patches_t
  use mpm_sparsity, only: assembly_map_t, turn_block
  use mpm_tensor, only: tensor_from_voigt, voigt_index
  implicit none
  private
  public :: apply_tangent, assemble_tangent, internal_force, scatter_block

contains

  !> Internal nodal forces. Elements are taken at the same time, their forces added in their order:
  !! the result does not depend on the number of threads. Source: theory.md (11).
  subroutine internal_force(f_int, mesh, kinematics, sums, element)
    real(dp), intent(out)            :: f_int(:, :) !! (n_dim, n_node)  [force]
    type(mesh_t), intent(in)         :: mesh
    type(kinematics_t), intent(in)   :: kinematics
    type(element_sums_t), intent(in) :: sums
    integer, intent(in)              :: element(:)  !! active elements
    real(dp), allocatable :: force(:, :, :)
    real(dp) :: stress(3, 3)
    integer :: i, e, a, n_dim

    n_dim = mesh%n_dim
    allocate (force(n_dim, n_dim + 1, size(element)))
    !$omp parallel do default(shared) private(e, stress)
    do i = 1, size(element)
      e = element(i)
      stress = tensor_from_voigt(sums%stress(:, e))
      force(:, :, i) = matmul(stress(1:n_dim, 1:n_dim), kinematics%grad_shape(:, :, e))
    end do
    !$omp end parallel do
    f_int = 0.0_dp
    do i = 1, size(element)
      do a = 1, n_dim + 1
        associate (node => mesh%node(a, element(i)))
          f_int(:, node) = f_int(:, node) + force(:, a, i)
        end associate
      end do
    end do
  end subroutine internal_force

  !> Values of the tangent. Patches of a colour share no node, colours are taken in turn: the
  !! result does not depend on the number of threads. Source: theory.md (12)-(14).
  subroutine assemble_tangent(tangent, map, mesh, patches, kinematics, sums)
    type(csc_matrix_t), intent(inout) :: tangent !! pattern built with map
    type(assembly_map_t), intent(in)  :: map
    type(mesh_t), intent(in)          :: mesh
    type(patches_t), intent(in)       :: patches
    type(kinematics_t), intent(in)    :: kinematics
    type(element_sums_t), intent(in)  :: sums
    real(dp), allocatable :: block(:, :)
    integer :: color, i

    tangent%val = 0.0_dp
    !$omp parallel default(shared) private(block, color, i)
    do color = 1, map%n_color
      !$omp do schedule(static)
      do i = map%color_first(color), map%color_first(color + 1) - 1
        call patch_tangent(block, map%color_patch(i), map, mesh, patches, kinematics, sums)
        call turn_block(block, map, map%color_patch(i))
        call scatter_block(tangent%val, map, map%color_patch(i), block)
      end do
      !$omp end do
    end do
    !$omp end parallel
  end subroutine assemble_tangent

  !> Adds a block to the values of the tangent, through the positions of the map.
  pure subroutine scatter_block(val, map, number, block)
    real(dp), intent(inout) :: val(0:)           !! values of the tangent
    type(assembly_map_t), intent(in) :: map
    integer, intent(in)     :: number            !! of the block in the map
    real(dp), intent(in)    :: block(:, :)       !! (n_eq, n_eq)
    integer(ip) :: k
    integer :: i, j, position

    k = map%position_first(number)
    do j = 1, size(block, 2)
      do i = 1, size(block, 1)
        position = map%position(k)
        if (position >= 0) val(position) = val(position) + block(i, j)
        k = k + 1_ip
      end do
    end do
  end subroutine scatter_block

  !> Product of the whole tangent, fixed directions included, with a nodal displacement,
  !! both along the global axes.
  subroutine apply_tangent(force, u, map, mesh, patches, kinematics, sums)
    real(dp), intent(out) :: force(:, :) !! (n_dim, n_node)  K u [force]
    real(dp), intent(in)  :: u(:, :)     !! (n_dim, n_node)  [length]
    type(assembly_map_t), intent(in) :: map
    type(mesh_t), intent(in)         :: mesh
    type(patches_t), intent(in)      :: patches
    type(kinematics_t), intent(in)   :: kinematics
    type(element_sums_t), intent(in) :: sums
    real(dp), allocatable :: block(:, :)
    integer :: i, patch, first, last

    force = 0.0_dp
    do i = 1, size(map%color_patch)
      patch = map%color_patch(i)
      first = map%node_first(patch)
      last = map%node_first(patch + 1) - 1
      if (all(abs(u(:, map%node(first:last))) <= 0.0_dp)) cycle
      call patch_tangent(block, patch, map, mesh, patches, kinematics, sums)
      force(:, map%node(first:last)) = force(:, map%node(first:last)) &
        + reshape(matmul(block, reshape(u(:, map%node(first:last)), [size(block, 1)])), &
                  [mesh%n_dim, last - first + 1])
    end do
  end subroutine apply_tangent

  !> Dense tangent of one patch over its nodes, the coupling of its elements once per patch.
  !! Source: theory.md (13), (13c).
  pure subroutine patch_tangent(block, patch, map, mesh, patches, kinematics, sums)
    real(dp), allocatable, intent(inout) :: block(:, :) !! (n_eq, n_eq), n_eq = n_dim times nodes
    integer, intent(in)              :: patch
    type(assembly_map_t), intent(in) :: map
    type(mesh_t), intent(in)         :: mesh
    type(patches_t), intent(in)      :: patches
    type(kinematics_t), intent(in)   :: kinematics
    type(element_sums_t), intent(in) :: sums
    integer :: n_eq

    n_eq = mesh%n_dim*(map%node_first(patch + 1) - map%node_first(patch))
    if (allocated(block)) then
      if (size(block, 1) /= n_eq) deallocate (block)
    end if
    if (.not. allocated(block)) allocate (block(n_eq, n_eq))
    associate (first => patches%first(patch), last => patches%first(patch + 1) - 1)
      ! With a constant number of dimensions the compiler unrolls the small loops inside.
      if (mesh%n_dim == 3) then
        call sum_elements(block, patches%element(first:last), 3, n_eq, map, kinematics, sums)
      else
        call sum_elements(block, patches%element(first:last), 2, n_eq, map, kinematics, sums)
      end if
    end associate
  end subroutine patch_tangent

  !> Adds up the tangents of the active elements of a patch and couples them.
  pure subroutine sum_elements(block, element, n_dim, n_eq, map, kinematics, sums)
    integer, intent(in)   :: n_dim, n_eq           !! dimensions, equations of the patch
    real(dp), intent(out) :: block(n_eq, n_eq)
    integer, intent(in)   :: element(:)            !! elements of the patch
    type(assembly_map_t), intent(in) :: map
    type(kinematics_t), intent(in)   :: kinematics
    type(element_sums_t), intent(in) :: sums
    real(dp) :: stiffness(n_dim, n_dim + 1, n_dim, n_dim + 1), coupling(n_dim, n_dim + 1)
    real(dp) :: divergence(n_dim, n_eq/n_dim), pressed(n_dim, n_eq/n_dim)
    integer :: a, e, m, n_active, node(n_dim + 1)

    block = 0.0_dp
    divergence = 0.0_dp
    pressed = 0.0_dp
    n_active = count(map%element_local(1, element) > 0)
    do m = 1, size(element)
      e = element(m)
      if (map%element_local(1, e) == 0) cycle
      node = map%element_local(:, e)
      call element_tangent(stiffness, kinematics%grad_shape(:, :, e), sums%moduli(:, :, e), &
                           sums%stress(:, e), n_dim)
      ! Alone in its patch an element keeps its own volume change: (13) has no coupling.
      if (n_active > 1) then
        call couple(stiffness, coupling, kinematics%grad_shape(:, :, e), sums%moduli(:, :, e), &
                    sums%stress(:, e), n_dim)
        do a = 1, n_dim + 1
          divergence(:, node(a)) = divergence(:, node(a)) &
                                   + kinematics%weight(e)*kinematics%grad_shape(:, a, e)
          pressed(:, node(a)) = pressed(:, node(a)) + coupling(:, a)
        end do
      end if
      call add_stiffness(block, stiffness, node, n_dim, n_eq)
    end do
    if (n_active > 1) call add_product(block, pressed, divergence, n_eq)
  end subroutine sum_elements

  !> Adds the tangent of an element to that of its patch.
  pure subroutine add_stiffness(block, stiffness, node, n_dim, n_eq)
    integer, intent(in)     :: n_dim, n_eq
    real(dp), intent(inout) :: block(n_dim, n_eq/n_dim, n_dim, n_eq/n_dim)         !! (i, a, k, b)
    real(dp), intent(in)    :: stiffness(n_dim, n_dim + 1, n_dim, n_dim + 1) !! (i, a, k, b)
    integer, intent(in)     :: node(n_dim + 1) !! numbers of its nodes within the patch
    integer :: a, b, k

    do b = 1, n_dim + 1
      do k = 1, n_dim
        do a = 1, n_dim + 1
          block(:, node(a), k, node(b)) = block(:, node(a), k, node(b)) + stiffness(:, a, k, b)
        end do
      end do
    end do
  end subroutine add_stiffness

  !> sum v [grad S]^T a [grad S] with a_ijkl = c_ijkl/Jbar + delta_ik sigma_jl. Source: theory.md (12).
  pure subroutine element_tangent(stiffness, grad_shape, moduli, stress, n_dim)
    integer, intent(in)   :: n_dim
    real(dp), intent(out) :: stiffness(n_dim, n_dim + 1, n_dim, n_dim + 1) !! (i, a, k, b)
    real(dp), intent(in)  :: grad_shape(n_dim, n_dim + 1) !! current gradients
    real(dp), intent(in)  :: moduli(6, 6)                 !! sum v c/Jbar
    real(dp), intent(in)  :: stress(6)                    !! sum v sigma
    real(dp) :: column(6)
    integer :: b, j, k

    do b = 1, n_dim + 1
      do k = 1, n_dim
        column = 0.0_dp
        do j = 1, n_dim
          column = column + moduli(:, voigt_index(k, j))*grad_shape(j, b)
        end do
        call spread_stress(stiffness(:, :, k, b), column, grad_shape, n_dim, n_dim + 1)
      end do
      call add_initial(stiffness(:, :, :, b), stress, grad_shape, b, n_dim)
    end do
  end subroutine element_tangent

  !> Nodal forces of a symmetric stress.
  pure subroutine spread_stress(force, stress, grad_shape, n_dim, n_node)
    integer, intent(in)   :: n_dim, n_node
    real(dp), intent(out) :: force(n_dim, n_node)
    real(dp), intent(in)  :: stress(6)                 !! 11, 22, 33, 12, 23, 13
    real(dp), intent(in)  :: grad_shape(n_dim, n_node) !! current gradients
    integer :: a, i, j

    do a = 1, n_node
      do i = 1, n_dim
        force(i, a) = 0.0_dp
        do j = 1, n_dim
          force(i, a) = force(i, a) + stress(voigt_index(i, j))*grad_shape(j, a)
        end do
      end do
    end do
  end subroutine spread_stress

  !> Adds what the stress that is there contributes to the columns of node b.
  pure subroutine add_initial(stiffness, stress, grad_shape, b, n_dim)
    integer, intent(in)     :: b, n_dim
    real(dp), intent(inout) :: stiffness(n_dim, n_dim + 1, n_dim) !! (i, a, k)
    real(dp), intent(in)    :: stress(6)                          !! sum v sigma
    real(dp), intent(in)    :: grad_shape(n_dim, n_dim + 1)       !! current gradients
    real(dp) :: traction(n_dim)
    integer :: a, k

    call spread_stress(traction, stress, grad_shape(:, b), n_dim, 1)
    do k = 1, n_dim
      do a = 1, n_dim + 1
        stiffness(k, a, k) = stiffness(k, a, k) + dot_product(grad_shape(:, a), traction)
      end do
    end do
  end subroutine add_initial

  !> Takes away the element's own share (G^T Q) tr g_e and gives [grad S]^T q with
  !! sum v q = (sum v c/Jbar : I + 2 sum v sigma)/n. Source: theory.md (13), (14a).
  pure subroutine couple(stiffness, coupling, grad_shape, moduli, stress, n_dim)
    integer, intent(in)     :: n_dim
    real(dp), intent(inout) :: stiffness(n_dim, n_dim + 1, n_dim, n_dim + 1) !! (i, a, k, b)
    real(dp), intent(out)   :: coupling(n_dim, n_dim + 1)   !! G^T Q
    real(dp), intent(in)    :: grad_shape(n_dim, n_dim + 1) !! current gradients
    real(dp), intent(in)    :: moduli(6, 6)                 !! sum v c/Jbar
    real(dp), intent(in)    :: stress(6)                    !! sum v sigma
    real(dp) :: q(6)
    integer :: b, j, k

    q = 2.0_dp*stress
    do j = 1, n_dim
      q = q + moduli(:, j)
    end do
    q = q/real(n_dim, dp)
    call spread_stress(coupling, q, grad_shape, n_dim, n_dim + 1)
    do b = 1, n_dim + 1
      do k = 1, n_dim
        stiffness(:, :, k, b) = stiffness(:, :, k, b) - coupling*grad_shape(k, b)
      end do
    end do
  end subroutine couple

  !> Adds the product of a column and a row.
  pure subroutine add_product(block, column, row, n)
    integer, intent(in)     :: n
    real(dp), intent(inout) :: block(n, n)
    real(dp), intent(in)    :: column(n), row(n)
    integer :: j

    do j = 1, n
      block(:, j) = block(:, j) + column*row(j)
    end do
  end subroutine add_product

end module mpm_assembly
