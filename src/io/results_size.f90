!> Size of the fields in the result files before they are compressed.
module mpm_results_size
  use mpm_kinds, only: dp
  use mpm_model, only: model_t
  use mpm_point_fields, only: is_integer_field, n_field_components
  use mpm_results_file, only: field_names, is_single
  implicit none
  private
  public :: bytes_of_output, bytes_once

  real(dp), parameter :: of_file = 1.0e5_dp !! structure of both files [bytes]

contains

  !> What each output of fields adds to both files.
  pure function bytes_of_output(model) result(n_bytes)
    type(model_t), intent(in) :: model
    real(dp) :: n_bytes !! [bytes]
    integer  :: i, of_point, of_real
    integer, parameter :: of_node = 4*3*8, of_element = 2*4 + 2*8

    of_real = merge(4, 8, is_single(model))
    of_point = 3*of_real
    associate (name => field_names(model))
      do i = 1, size(name)
        of_point = of_point + n_field_components(trim(name(i))) &
                   *merge(4, of_real, is_integer_field(trim(name(i))))
      end do
    end associate
    n_bytes = real(of_point, dp)*real(model%points%n, dp) &
              + real(of_node, dp)*real(model%mesh%n_node, dp) &
              + real(of_element, dp)*real(model%mesh%n_el, dp)
  end function bytes_of_output

  !> What is written once: cells and their patches.
  pure function bytes_once(model) result(n_bytes)
    type(model_t), intent(in) :: model
    real(dp) :: n_bytes !! [bytes]
    integer, parameter :: of_point = 8 + 8 + 1

    n_bytes = of_file + real(of_point, dp)*real(model%points%n, dp) &
              + real(8*(model%mesh%n_dim + 1) + 8 + 1 + 4, dp)*real(model%mesh%n_el, dp)
  end function bytes_once

end module mpm_results_size
