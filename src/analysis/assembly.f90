!> Internal force and tangent from the element sums, element by element and patch by patch.
module mpm_assembly
  use mpm_constitutive_update, only: element_sums_t
  use mpm_csc_matrix, only: csc_matrix_t
  use mpm_kinds, only: dp, ip
  use mpm_kinematics, only: kinematics_t
  use mpm_mesh, only: mesh_t
  use mpm_patches, only: patches_t
  use mpm_sparsity, only: assembly_map_t, turn_block
  use mpm_tensor, only: tensor_from_voigt
  implicit none
  private
  public :: apply_tangent, assemble_tangent, internal_force, scatter_block

  integer, parameter :: voigt_index(3, 3) = reshape([1, 4, 6, 4, 2, 5, 6, 5, 3], [3, 3])
    !! Voigt component of a tensor index pair

contains

  !> Internal nodal forces. Source: theory.md (11).
  pure subroutine internal_force(f_int, mesh, kinematics, sums, element)
    real(dp), intent(out)            :: f_int(:, :) !! (n_dim, n_node)  [force]
    type(mesh_t), intent(in)         :: mesh
    type(kinematics_t), intent(in)   :: kinematics
    type(element_sums_t), intent(in) :: sums
    integer, intent(in)              :: element(:)  !! active elements
    real(dp) :: stress(3, 3)
    integer :: i, e, a, n_dim

    n_dim = mesh%n_dim
    f_int = 0.0_dp
    do i = 1, size(element)
      e = element(i)
      stress = tensor_from_voigt(sums%stress(:, e))
      do a = 1, n_dim + 1
        f_int(:, mesh%node(a, e)) = f_int(:, mesh%node(a, e)) &
          + matmul(stress(1:n_dim, 1:n_dim), kinematics%grad_shape(:, a, e))
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
    integer(ip) :: k, position
    integer :: i, j

    k = map%position_first(number)
    do j = 1, size(block, 2)
      do i = 1, size(block, 1)
        position = map%position(k)
        if (position >= 0_ip) val(position) = val(position) + block(i, j)
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

  !> Dense tangent of one patch over its nodes. Source: theory.md (13).
  pure subroutine patch_tangent(block, patch, map, mesh, patches, kinematics, sums)
    real(dp), allocatable, intent(inout) :: block(:, :) !! (n_eq, n_eq), n_eq = n_dim times nodes
    integer, intent(in)              :: patch
    type(assembly_map_t), intent(in) :: map
    type(mesh_t), intent(in)         :: mesh
    type(patches_t), intent(in)      :: patches
    type(kinematics_t), intent(in)   :: kinematics
    type(element_sums_t), intent(in) :: sums
    real(dp), allocatable :: divergence(:)
    real(dp) :: coupling(mesh%n_dim, mesh%n_dim + 1)
    integer :: equation(mesh%n_dim, mesh%n_dim + 1)
    integer :: i, e, n_eq, n_active

    n_eq = mesh%n_dim*(map%node_first(patch + 1) - map%node_first(patch))
    if (allocated(block)) then
      if (size(block, 1) /= n_eq) deallocate (block)
    end if
    if (.not. allocated(block)) allocate (block(n_eq, n_eq))
    block = 0.0_dp
    allocate (divergence(n_eq), source=0.0_dp)
    n_active = 0
    do i = patches%first(patch), patches%first(patch + 1) - 1
      e = patches%element(i)
      if (map%element_local(1, e) == 0) cycle
      n_active = n_active + 1
      equation = local_equations(map%element_local(:, e), mesh%n_dim)
      call add_stiffness(block, equation, kinematics%grad_shape(:, :, e), sums%moduli(:, :, e), &
                         sums%stress(:, e))
      call add_divergence(divergence, equation, kinematics%weight(e)*kinematics%grad_shape(:, :, e))
    end do
    ! Alone in its patch an element keeps its own volume change: (13) has no coupling.
    if (n_active < 2) return
    do i = patches%first(patch), patches%first(patch + 1) - 1
      e = patches%element(i)
      if (map%element_local(1, e) == 0) cycle
      equation = local_equations(map%element_local(:, e), mesh%n_dim)
      coupling = coupling_force(kinematics%grad_shape(:, :, e), sums%moduli(:, :, e), sums%stress(:, e))
      call add_coupling(block, equation, coupling, divergence, kinematics%grad_shape(:, :, e))
    end do
  end subroutine patch_tangent

  !> Equations of an element within the block of its patch.
  pure function local_equations(local_node, n_dim) result(equation)
    integer, intent(in) :: local_node(:)                 !! (n_dim+1)  numbers within the patch
    integer, intent(in) :: n_dim
    integer :: equation(n_dim, size(local_node))
    integer :: a, i

    do a = 1, size(local_node)
      do i = 1, n_dim
        equation(i, a) = (local_node(a) - 1)*n_dim + i
      end do
    end do
  end function local_equations

  !> sum v [grad S]^T a [grad S] with a_ijkl = c_ijkl/Jbar + delta_ik sigma_jl. Source: theory.md (12).
  pure subroutine add_stiffness(block, equation, grad_shape, moduli, stress)
    real(dp), intent(inout) :: block(:, :)        !! (n_eq, n_eq)
    integer, intent(in)     :: equation(:, :)     !! (n_dim, n_dim+1)
    real(dp), intent(in)    :: grad_shape(:, :)   !! (n_dim, n_dim+1)  current gradients
    real(dp), intent(in)    :: moduli(6, 6)       !! sum v c/Jbar
    real(dp), intent(in)    :: stress(6)          !! sum v sigma
    real(dp) :: column(6), tensor(3, 3), rate(3, 3)
    real(dp) :: traction(size(grad_shape, 1)), force(size(grad_shape, 1))
    integer :: a, b, j, k, n_dim

    n_dim = size(grad_shape, 1)
    tensor = tensor_from_voigt(stress)
    do b = 1, n_dim + 1
      traction = matmul(tensor(1:n_dim, 1:n_dim), grad_shape(:, b))
      do k = 1, n_dim
        column = 0.0_dp
        do j = 1, n_dim
          column = column + moduli(:, voigt_index(k, j))*grad_shape(j, b)
        end do
        rate = tensor_from_voigt(column)
        do a = 1, n_dim + 1
          force = matmul(rate(1:n_dim, 1:n_dim), grad_shape(:, a))
          force(k) = force(k) + dot_product(grad_shape(:, a), traction)
          block(equation(:, a), equation(k, b)) = block(equation(:, a), equation(k, b)) + force
        end do
      end do
    end do
  end subroutine add_stiffness

  !> Adds w_s times the divergence row of an element to that of its patch.
  pure subroutine add_divergence(divergence, equation, weighted_gradient)
    real(dp), intent(inout) :: divergence(:)           !! (n_eq)  t_P as a row over the patch nodes
    integer, intent(in)     :: equation(:, :)          !! (n_dim, n_dim+1)
    real(dp), intent(in)    :: weighted_gradient(:, :) !! (n_dim, n_dim+1)
    integer :: a

    do a = 1, size(equation, 2)
      divergence(equation(:, a)) = divergence(equation(:, a)) + weighted_gradient(:, a)
    end do
  end subroutine add_divergence

  !> [grad S]^T q with sum v q = (sum v c/Jbar : I + 2 sum v sigma)/n. Source: theory.md (14).
  pure function coupling_force(grad_shape, moduli, stress) result(force)
    real(dp), intent(in) :: grad_shape(:, :) !! (n_dim, n_dim+1)
    real(dp), intent(in) :: moduli(6, 6)     !! sum v c/Jbar
    real(dp), intent(in) :: stress(6)        !! sum v sigma
    real(dp) :: force(size(grad_shape, 1), size(grad_shape, 2))
    real(dp) :: q(3, 3)
    integer :: n_dim

    n_dim = size(grad_shape, 1)
    q = tensor_from_voigt((sum(moduli(:, 1:n_dim), dim=2) + 2.0_dp*stress)/real(n_dim, dp))
    force = matmul(q(1:n_dim, 1:n_dim), grad_shape)
  end function coupling_force

  !> Adds the rank-one coupling (G^T Q) (t_P - tr g_e). Source: theory.md (13).
  pure subroutine add_coupling(block, equation, coupling, divergence, grad_shape)
    real(dp), intent(inout) :: block(:, :)      !! (n_eq, n_eq)
    integer, intent(in)     :: equation(:, :)   !! (n_dim, n_dim+1)
    real(dp), intent(in)    :: coupling(:, :)   !! (n_dim, n_dim+1)  G^T Q of the element
    real(dp), intent(in)    :: divergence(:)    !! (n_eq)  t_P
    real(dp), intent(in)    :: grad_shape(:, :) !! (n_dim, n_dim+1)
    real(dp) :: row(size(divergence))
    integer :: a, i, j

    row = divergence
    do a = 1, size(equation, 2)
      row(equation(:, a)) = row(equation(:, a)) - grad_shape(:, a)
    end do
    do j = 1, size(row)
      do a = 1, size(equation, 2)
        do i = 1, size(equation, 1)
          block(equation(i, a), j) = block(equation(i, a), j) + coupling(i, a)*row(j)
        end do
      end do
    end do
  end subroutine add_coupling

end module mpm_assembly
