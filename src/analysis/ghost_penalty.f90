!> Ghost penalty: holds the gradient of the increment together at the edge of the body.
!!
!! An element that is barely filled gives its nodes almost no stiffness, or a negative one by the
!! stress left over in it; one that hangs on the body by a single node turns freely. The penalty
!! resists a difference between the displacement gradients of such an element and its neighbour.
!! It is linear in the displacement of the increment and starts from zero in every increment.
module mpm_ghost_penalty
  use mpm_assembly, only: scatter_block
  use mpm_csc_matrix, only: csc_matrix_t
  use mpm_ghost_pairs, only: find_ghost_pairs, ghost_pairs_t
  use mpm_kinds, only: dp
  use mpm_material, only: material_t
  use mpm_material_points, only: points_t
  use mpm_mesh, only: mesh_t
  use mpm_sparsity, only: assembly_map_t, lists_t, turn_block
  implicit none
  private
  public :: ghost_penalty_t, default_gamma
  public :: add_ghost_force, add_ghost_tangent, build_ghost, ghost_block, ghost_energy
  public :: ghost_share, open_ghost

  real(dp), parameter :: rounding = 1.0e-9_dp    !! jumps below this part of the motion are none
  real(dp), parameter :: default_gamma = 5.0e-4_dp !! factor without GAMMA in the deck [-]

  !> The pairs of an increment and their coefficients.
  type :: ghost_penalty_t
    type(ghost_pairs_t) :: pairs
    type(lists_t) :: node                     !! nodes of each pair, each once
    real(dp), allocatable :: jump(:, :)       !! (n_dim, n)  d_a of each of these nodes [1/length]
    real(dp), allocatable :: stiffness(:)     !! (n_pair)    gamma E h_F A_F / 3 [force length]
  end type ghost_penalty_t

contains

  !> A penalty without pairs.
  pure subroutine open_ghost(ghost, n_dim)
    type(ghost_penalty_t), intent(out) :: ghost !! without pairs
    integer, intent(in) :: n_dim                !! 2 or 3

    allocate (ghost%pairs%element(2, 0), ghost%node%item(0), ghost%jump(n_dim, 0))
    allocate (ghost%stiffness(0))
    ghost%node%first = [1]
  end subroutine open_ghost

  !> Finds the pairs of an active set and their coefficients; none without a penalty.
  !! Source: theory.md (18).
  pure subroutine build_ghost(ghost, gamma, mesh, points, materials, active)
    type(ghost_penalty_t), intent(out) :: ghost
    real(dp), intent(in)         :: gamma     !! factor of the penalty [-], 0 = no penalty
    type(mesh_t), intent(in)     :: mesh      !! at the start of the increment
    type(points_t), intent(in)   :: points    !! grouped by element
    type(material_t), intent(in) :: materials(:)
    logical, intent(in)          :: active(:) !! (n_el)  hosts a point
    integer :: pair

    call open_ghost(ghost, mesh%n_dim)
    if (gamma <= 0.0_dp) return
    call find_ghost_pairs(ghost%pairs, mesh, active, filled_part(mesh, points))
    call collect_jumps(ghost, mesh)
    ghost%stiffness = [(gamma*pair_size(ghost, mesh, pair)/3.0_dp &
                        *largest_young(points, materials, ghost%pairs%element(:, pair)), &
                        pair=1, ghost%pairs%n)]
  end subroutine build_ghost

  !> Volume of the points of each element over its own.
  pure function filled_part(mesh, points) result(filled)
    type(mesh_t), intent(in)   :: mesh
    type(points_t), intent(in) :: points !! grouped by element
    real(dp) :: filled(mesh%n_el)        !! [-]
    integer :: e

    do e = 1, mesh%n_el
      filled(e) = sum(points%volume(points%order(points%first(e):points%first(e + 1) - 1))) &
                  /mesh%volume(e)
    end do
  end function filled_part

  !> Nodes of all pairs, and d_a = G_a of the first element less G_a of the second.
  pure subroutine collect_jumps(ghost, mesh)
    type(ghost_penalty_t), intent(inout) :: ghost !! pairs are set
    type(mesh_t), intent(in) :: mesh              !! at the start of the increment
    integer, allocatable  :: node(:)
    real(dp), allocatable :: jump(:, :)
    integer :: a, first, k, n, pair, n_corner

    n_corner = mesh%n_dim + 1
    allocate (node(2*n_corner*ghost%pairs%n), jump(mesh%n_dim, 2*n_corner*ghost%pairs%n))
    deallocate (ghost%node%first)
    allocate (ghost%node%first(ghost%pairs%n + 1))
    n = 0
    do pair = 1, ghost%pairs%n
      ghost%node%first(pair) = n + 1
      first = n + 1
      associate (e => ghost%pairs%element(1, pair), s => ghost%pairs%element(2, pair))
        node(first:n + n_corner) = mesh%node(:, e)
        jump(:, first:n + n_corner) = mesh%grad_shape(:, :, e)
        n = n + n_corner
        do a = 1, n_corner
          k = first - 1 + findloc(node(first:n), mesh%node(a, s), dim=1)
          if (k < first) then
            n = n + 1
            k = n
            node(k) = mesh%node(a, s)
            jump(:, k) = 0.0_dp
          end if
          jump(:, k) = jump(:, k) - mesh%grad_shape(:, a, s)
        end do
      end associate
    end do
    ghost%node%first(ghost%pairs%n + 1) = n + 1
    ghost%node%item = node(:n)
    ghost%jump = jump(:, :n)
  end subroutine collect_jumps

  !> h_F A_F of the face of a pair; without a common face, that of a face of a regular size.
  pure function pair_size(ghost, mesh, pair) result(volume)
    type(ghost_penalty_t), intent(in) :: ghost !! pairs are set
    type(mesh_t), intent(in) :: mesh           !! at the start of the increment
    integer, intent(in)      :: pair
    real(dp) :: volume                         !! [length^n_dim]
    real(dp) :: area
    integer  :: opposite

    associate (e => ghost%pairs%element(1, pair), s => ghost%pairs%element(2, pair), &
               n_dim => mesh%n_dim)
      opposite = findloc(mesh%neighbour(:, e), s, dim=1)
      if (opposite > 0) then
        area = real(n_dim, dp)*mesh%volume(e)*norm2(mesh%grad_shape(:, opposite, e))
        volume = area**(real(n_dim, dp)/real(n_dim - 1, dp))
      else
        volume = real(n_dim, dp)*min(mesh%volume(e), mesh%volume(s))
      end if
    end associate
  end function pair_size

  !> Largest Young's modulus of the points in the two elements of a pair.
  pure function largest_young(points, materials, element) result(young)
    type(points_t), intent(in)   :: points     !! grouped by element
    type(material_t), intent(in) :: materials(:)
    integer, intent(in)          :: element(:) !! (2)
    real(dp) :: young                          !! [force/length^2]
    integer :: i, k

    young = 0.0_dp
    do k = 1, size(element)
      do i = points%first(element(k)), points%first(element(k) + 1) - 1
        young = max(young, materials(points%material(points%order(i)))%young)
      end do
    end do
  end function largest_young

  !> Adds the forces of the penalty, f_a = k sum_b (d_a.d_b) u_b. Source: theory.md (18).
  pure subroutine add_ghost_force(force, ghost, u)
    real(dp), intent(inout) :: force(:, :)     !! (n_dim, n_node)  [force]
    type(ghost_penalty_t), intent(in) :: ghost !! built
    real(dp), intent(in) :: u(:, :)            !! (n_dim, n_node)  displacement of the increment
    real(dp) :: difference(size(u, 1), size(u, 1))
    integer :: i, pair

    do pair = 1, ghost%pairs%n
      difference = ghost%stiffness(pair)*gradient_jump(ghost, u, pair)
      do i = ghost%node%first(pair), ghost%node%first(pair + 1) - 1
        associate (a => ghost%node%item(i))
          force(:, a) = force(:, a) + matmul(difference, ghost%jump(:, i))
        end associate
      end do
    end do
  end subroutine add_ghost_force

  !> Displacement gradient in the first element of a pair less that in the second.
  pure function gradient_jump(ghost, u, pair) result(difference)
    type(ghost_penalty_t), intent(in) :: ghost !! built
    real(dp), intent(in) :: u(:, :)            !! (n_dim, n_node)  displacement of the increment
    integer, intent(in)  :: pair
    real(dp) :: difference(size(u, 1), size(u, 1)) !! [-]

    associate (first => ghost%node%first(pair), last => ghost%node%first(pair + 1) - 1)
      difference = matmul(u(:, ghost%node%item(first:last)), transpose(ghost%jump(:, first:last)))
    end associate
  end function gradient_jump

  !> Adds the blocks of all pairs to the tangent, colour by colour: the result does not depend on
  !! the number of threads.
  subroutine add_ghost_tangent(tangent, map, ghost)
    type(csc_matrix_t), intent(inout) :: tangent !! pattern built with map
    type(assembly_map_t), intent(in)  :: map     !! built with the pairs
    type(ghost_penalty_t), intent(in) :: ghost   !! built
    real(dp), allocatable :: block(:, :)
    integer :: color, i

    !$omp parallel default(shared) private(block, color, i)
    do color = 1, map%n_pair_color
      !$omp do schedule(static)
      do i = map%pair_color_first(color), map%pair_color_first(color + 1) - 1
        block = ghost_block(ghost, map%color_pair(i))
        call turn_block(block, map, map%n_patch + map%color_pair(i))
        call scatter_block(tangent%val, map, map%n_patch + map%color_pair(i), block)
      end do
      !$omp end do
    end do
    !$omp end parallel
  end subroutine add_ghost_tangent

  !> Stiffness of a pair over its nodes, k (d_a.d_b) I. Source: theory.md (18).
  pure function ghost_block(ghost, pair) result(block)
    type(ghost_penalty_t), intent(in) :: ghost !! built
    integer, intent(in) :: pair
    real(dp), allocatable :: block(:, :)       !! (n_eq, n_eq), n_eq = n_dim times nodes
    real(dp) :: stiffness
    integer :: a, b, first, i, n, n_dim

    n_dim = size(ghost%jump, 1)
    first = ghost%node%first(pair)
    n = ghost%node%first(pair + 1) - first
    allocate (block(n_dim*n, n_dim*n), source=0.0_dp)
    do b = 1, n
      do a = 1, n
        stiffness = ghost%stiffness(pair)*dot_product(ghost%jump(:, first + a - 1), &
                                                      ghost%jump(:, first + b - 1))
        do i = 1, n_dim
          block((a - 1)*n_dim + i, (b - 1)*n_dim + i) = stiffness
        end do
      end do
    end do
  end function ghost_block

  !> Energy of the penalty, half of its virtual work on its own displacement.
  pure function ghost_energy(ghost, u) result(energy)
    type(ghost_penalty_t), intent(in) :: ghost !! built
    real(dp), intent(in) :: u(:, :)            !! (n_dim, n_node)  displacement of the increment
    real(dp) :: energy                         !! [force length]
    integer :: pair

    energy = 0.0_dp
    do pair = 1, ghost%pairs%n
      energy = energy + 0.5_dp*ghost%stiffness(pair)*sum(gradient_jump(ghost, u, pair)**2)
    end do
  end function ghost_energy

  !> Part of the load that the penalty carries, in the sense of virtual work.
  !! Source: theory.md (18d).
  pure function ghost_share(ghost, u, work, motion) result(share)
    type(ghost_penalty_t), intent(in) :: ghost !! built
    real(dp), intent(in) :: u(:, :)            !! (n_dim, n_node)  displacement of the increment
    real(dp), intent(in) :: work               !! to compare with, reference_work [force length]
    real(dp), intent(in) :: motion             !! largest displacement of the run [length]
    real(dp) :: share                          !! [-], 0 where all jumps are rounding errors
    real(dp) :: noise
    integer  :: pair

    share = 2.0_dp*ghost_energy(ghost, u)
    noise = sum([(ghost%stiffness(pair)*sum(ghost%jump(:, ghost%node%first(pair): &
                                             ghost%node%first(pair + 1) - 1)**2), &
                  pair=1, ghost%pairs%n)])*(rounding*motion)**2
    if (share > noise) then
      share = share/max(work, tiny(work)/epsilon(work))
    else
      share = 0.0_dp
    end if
  end function ghost_share

end module mpm_ghost_penalty
