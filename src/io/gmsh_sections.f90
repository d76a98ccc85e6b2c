!> The sections of a gmsh file, formats 2.2 and 4.1 in ASCII.
module mpm_gmsh_sections
  use mpm_gmsh_elements, only: read_elements_22, read_elements_41
  use mpm_gmsh_mesh, only: gmsh_block_t, gmsh_group_t, gmsh_mesh_t, grow_blocks, &
    & max_groups
  use mpm_gmsh_nodes, only: read_nodes_22, read_nodes_41
  use mpm_gmsh_scanner, only: end_line, fail_at_line, fail_at_token, failed, gmsh_scanner_t, &
    & next_count, next_integer, next_line, next_real, next_word, read_count, rest_of_line
  use mpm_kinds, only: dp, ip
  use mpm_source_excerpt, only: printable
  use mpm_text, only: integer_text, same_name
  implicit none
  private
  public :: read_sections

  integer, parameter :: max_name = 80 !! characters of a name, as in a deck

contains

  !> Reads all sections of a file.
  subroutine read_sections(raw, scanner)
    type(gmsh_mesh_t), intent(out) :: raw          !! content
    type(gmsh_scanner_t), intent(inout) :: scanner !! holds the failure if there is one
    logical :: found

    allocate (raw%group(0), raw%entity(0), raw%block(0))
    call next_line(scanner, "$MeshFormat")
    call open_section(scanner)
    if (failed(scanner)) return
    if (scanner%section /= "$MeshFormat") then
      call fail_at_token(scanner, "not a gmsh mesh: expected $MeshFormat in the first line")
      return
    end if
    call read_format(raw, scanner)
    do
      call close_section(scanner)
      call next_line(scanner, "a section", found)
      if (.not. found) exit
      call open_section(scanner)
      if (failed(scanner)) return
      call read_section(raw, scanner)
    end do
    if (failed(scanner)) return
    if (.not. allocated(raw%node_tag)) call fail_at_line(scanner, scanner%line, &
      & "the file ends: expected a section $Nodes")
    if (.not. allocated(raw%el_tag)) call fail_at_line(scanner, scanner%line, &
      & "the file ends: expected a section $Elements")
  end subroutine read_sections

  !> Reads the content of the section that was opened.
  subroutine read_section(raw, scanner)
    type(gmsh_mesh_t), intent(inout) :: raw        !! takes the content
    type(gmsh_scanner_t), intent(inout) :: scanner !! behind the first line of the section

    select case (scanner%section)
    case ("$PhysicalNames")
      call read_names(raw, scanner)
    case ("$Entities")
      call read_entities(raw, scanner)
    case ("$Nodes")
      if (allocated(raw%node_tag)) then
        call fail_at_token(scanner, "second section $Nodes: expected one")
      else if (raw%version == 41) then
        call read_nodes_41(raw, scanner)
      else
        call read_nodes_22(raw, scanner)
      end if
    case ("$Elements")
      if (allocated(raw%el_tag)) then
        call fail_at_token(scanner, "second section $Elements: expected one")
      else if (.not. allocated(raw%node_tag)) then
        call fail_at_token(scanner, "$Elements before $Nodes: expected $Nodes first")
      else if (raw%version == 41) then
        call read_elements_41(raw, scanner)
      else
        call read_elements_22(raw, scanner)
      end if
    case ("$MeshFormat")
      call fail_at_token(scanner, "second section $MeshFormat: expected one")
    case default
      call skip_section(scanner)
    end select
  end subroutine read_section

  !> Reads the line that opens a section.
  subroutine open_section(scanner)
    type(gmsh_scanner_t), intent(inout) :: scanner !! section is set

    call next_word(scanner, "a section such as $Nodes")
    if (failed(scanner)) return
    scanner%section = scanner%text(scanner%word_first:min(scanner%at - 1, scanner%word_first + 40))
    if (scanner%section(1:1) /= "$" .or. index(scanner%section, "$End") == 1) then
      scanner%section = ""
      call fail_at_token(scanner, "expected the start of a section such as $MeshFormat or $Nodes")
      return
    end if
    call end_line(scanner, "the line to end behind "//scanner%section)
  end subroutine open_section

  !> Reads the line that closes a section.
  subroutine close_section(scanner)
    type(gmsh_scanner_t), intent(inout) :: scanner !! at the line
    character(:), allocatable :: expected

    if (failed(scanner)) return
    expected = "$End"//scanner%section(2:)
    call next_line(scanner, expected)
    call next_word(scanner, expected)
    if (failed(scanner)) return
    if (scanner%text(scanner%word_first:scanner%at - 1) /= expected) then
      call fail_at_token(scanner, "more lines than "//scanner%section//" announces: expected " &
                         //expected)
      return
    end if
    call end_line(scanner, "the line to end behind "//expected)
    scanner%section = ""
  end subroutine close_section

  !> Skips a section that does not matter here, up to the line that closes it.
  subroutine skip_section(scanner)
    type(gmsh_scanner_t), intent(inout) :: scanner !! at the line that closes the section
    character(:), allocatable :: closing

    closing = "$End"//scanner%section(2:)
    do
      call next_line(scanner, closing)
      if (failed(scanner)) return
      if (index(scanner%text(scanner%at:scanner%line_last), closing) == 1) exit
      scanner%at = scanner%line_last + 2
    end do
    scanner%line = scanner%line - 1
  end subroutine skip_section

  !> $MeshFormat: version, ASCII or binary.
  subroutine read_format(raw, scanner)
    type(gmsh_mesh_t), intent(inout) :: raw        !! version is set
    type(gmsh_scanner_t), intent(inout) :: scanner !! behind the line
    real(dp) :: version
    integer :: file_type, data_size

    call next_line(scanner, "the format, such as '4.1 0 8'")
    call next_real(scanner, version, "the format, 2.2 or 4.1")
    if (failed(scanner)) return
    raw%version = nint(10.0_dp*max(0.0_dp, min(100.0_dp, version)))
    if (raw%version /= 22 .and. raw%version /= 41) then
      call fail_at_token(scanner, "format "//scanner%text(scanner%word_first:scanner%at - 1) &
                         //" is not supported: expected 2.2 or 4.1 (in gmsh: -format msh41)")
      return
    end if
    call next_integer(scanner, file_type, "0 for ASCII")
    if (failed(scanner)) return
    if (file_type /= 0) then
      call fail_at_token(scanner, "the mesh is binary: expected ASCII, 0 here " &
                         //"(in gmsh: without -bin, Mesh.Binary = 0)")
      return
    end if
    call next_integer(scanner, data_size, "the size of a number, 8")
    call end_line(scanner, "three numbers")
  end subroutine read_format

  !> $PhysicalNames: dimension, number and name of groups.
  subroutine read_names(raw, scanner)
    type(gmsh_mesh_t), intent(inout) :: raw        !! groups are added
    type(gmsh_scanner_t), intent(inout) :: scanner !! behind the lines
    type(gmsh_group_t) :: group
    integer :: n, i

    call read_count(scanner, n, "the number of physical names")
    if (n > max_groups) call fail_at_line(scanner, scanner%line, integer_text(n) &
      & //" physical names: expected at most "//integer_text(max_groups))
    do i = 1, n
      if (failed(scanner)) return
      call next_line(scanner, "physical name "//integer_text(i)//" of "//integer_text(n))
      call next_integer(scanner, group%dim, "the dimension of a physical group")
      call next_integer(scanner, group%tag, "the number of a physical group")
      call rest_of_line(scanner, group%name)
      if (failed(scanner)) return
      if (len(group%name) < 3 .or. index(group%name, '"') /= 1 .or. &
          index(group%name, '"', back=.true.) /= len(group%name)) then
        call fail_at_token(scanner, "expected the name of a physical group in double quotes")
        return
      end if
      group%name = group%name(2:len(group%name) - 1)
      group%line = scanner%line
      if (len(group%name) > max_name .or. group%name /= printable(group%name)) then
        call fail_at_token(scanner, "expected the name of a physical group as text in UTF-8, at " &
                           //"most "//integer_text(max_name)//" characters")
        return
      end if
      call check_name(raw, scanner, group%name)
      raw%group = [raw%group, group]
    end do
  end subroutine read_names

  !> The name of a group must be new: it becomes the name of a set of nodes, too.
  subroutine check_name(raw, scanner, name)
    type(gmsh_mesh_t), intent(in) :: raw           !! groups so far
    type(gmsh_scanner_t), intent(inout) :: scanner !! at the name
    character(*), intent(in) :: name               !! new name
    integer :: i

    do i = 1, size(raw%group)
      if (same_name(raw%group(i)%name, name)) call fail_at_token(scanner, "the name '"//name &
        & //"' was given in line "//integer_text(raw%group(i)%line)//" already: expected " &
        & //"different names, case does not count")
    end do
  end subroutine check_name

  !> $Entities (4.1): the physical groups of points, curves, surfaces and volumes.
  subroutine read_entities(raw, scanner)
    type(gmsh_mesh_t), intent(inout) :: raw        !! entities are added
    type(gmsh_scanner_t), intent(inout) :: scanner !! behind the lines
    type(gmsh_block_t), allocatable :: entity(:)
    integer :: n(0:3), dim, i, n_entity

    call next_line(scanner, "the numbers of points, curves, surfaces and volumes")
    do dim = 0, 3
      call next_count(scanner, n(dim), "the number of entities of dimension "//integer_text(dim))
    end do
    call end_line(scanner, "four counts")
    if (failed(scanner)) return
    if (sum(int(n, ip)) > huge(1)) then
      call fail_at_token(scanner, "too many entities: expected at most "//integer_text(huge(1)))
      return
    end if
    allocate (entity(0))
    n_entity = 0
    do dim = 0, 3
      do i = 1, n(dim)
        n_entity = n_entity + 1
        call grow_blocks(entity, n_entity, sum(n))
        call read_entity(entity(n_entity), scanner, dim)
        if (failed(scanner)) return
      end do
    end do
    call move_alloc(entity, raw%entity)
  end subroutine read_entities

  !> One line of $Entities.
  subroutine read_entity(entity, scanner, dim)
    type(gmsh_block_t), intent(out) :: entity      !! number and physical groups
    type(gmsh_scanner_t), intent(inout) :: scanner !! behind the line
    integer, intent(in) :: dim                     !! dimension
    character(:), allocatable :: rest
    real(dp) :: bound
    integer :: i, n_group

    entity%dim = dim
    call next_line(scanner, "an entity of dimension "//integer_text(dim))
    call next_integer(scanner, entity%tag, "the number of an entity of dimension " &
                      //integer_text(dim))
    do i = 1, merge(3, 6, dim == 0)
      call next_real(scanner, bound, "a coordinate of the entity")
    end do
    call next_count(scanner, n_group, "the number of physical groups of the entity")
    allocate (entity%group(n_group))
    do i = 1, n_group
      call next_integer(scanner, entity%group(i), "the number of a physical group")
      entity%group(i) = abs(entity%group(i))
    end do
    call rest_of_line(scanner, rest)
  end subroutine read_entity

end module mpm_gmsh_sections
