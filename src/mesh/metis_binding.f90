!> Interfaces to METIS 5 with 32-bit indices and reals, no logic.
! allow(assumed-size)
module mpm_metis_binding
  use, intrinsic :: iso_c_binding, only: c_float, c_int, c_int32_t, c_ptr
  implicit none
  private
  public :: metis_n_options, metis_ok, metis_option_seed
  public :: metis_part_graph_recursive, metis_set_default_options

  integer, parameter :: metis_n_options = 40        !! METIS_NOPTIONS
  integer, parameter :: metis_option_seed = 9       !! METIS_OPTION_SEED, counted from 1
  integer(c_int), parameter :: metis_ok = 1_c_int   !! METIS_OK

  interface

    !> Fills the options with their defaults.
    function metis_set_default_options(options) bind(c, name="METIS_SetDefaultOptions") &
        result(status)
      import :: c_int, c_int32_t
      implicit none
      integer(c_int32_t), intent(out) :: options(*) !! (metis_n_options)
      integer(c_int) :: status                      !! metis_ok or an error
    end function metis_set_default_options

    !> Partition of a graph into parts of given weights. Indices count from zero.
    function metis_part_graph_recursive(n_vertex, n_constraint, first, adjacent, vertex_weight, &
        vertex_size, edge_weight, n_part, part_weight, imbalance, options, cut, part) &
        bind(c, name="METIS_PartGraphRecursive") result(status)
      import :: c_float, c_int, c_int32_t, c_ptr
      implicit none
      integer(c_int32_t), intent(in)  :: n_vertex     !! vertices
      integer(c_int32_t), intent(in)  :: n_constraint !! balancing constraints
      integer(c_int32_t), intent(in)  :: first(*)     !! (n_vertex+1)  start of each adjacency list
      integer(c_int32_t), intent(in)  :: adjacent(*)  !! (first(n_vertex))  adjacency lists
      type(c_ptr), value              :: vertex_weight !! null: all one
      type(c_ptr), value              :: vertex_size   !! null: all one
      type(c_ptr), value              :: edge_weight   !! null: all one
      integer(c_int32_t), intent(in)  :: n_part       !! parts, at least 2
      real(c_float), intent(in)       :: part_weight(*) !! (n_part)  shares, sum 1
      type(c_ptr), value              :: imbalance     !! null: default
      integer(c_int32_t), intent(in)  :: options(*)   !! (metis_n_options)
      integer(c_int32_t), intent(out) :: cut          !! edges cut
      integer(c_int32_t), intent(out) :: part(*)      !! (n_vertex)  part of each vertex, from zero
      integer(c_int) :: status                        !! metis_ok or an error
    end function metis_part_graph_recursive

  end interface

end module mpm_metis_binding
