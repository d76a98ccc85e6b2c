!> The command line: options, their help, and what is wrong with them.
module mpm_command_line
  use mpm_build_info, only: build_type, compiler, git_revision, version
  use mpm_error, only: error_t, exit_usage, make_error
  use mpm_kinds, only: dp
  use mpm_library_text, only: library_text
  use mpm_model, only: formulation_fbar, formulation_standard
  use mpm_text, only: nearest_word, normalize_keyword, parse_integer, parse_real
  implicit none
  private
  public :: command_line_t, get_arguments, read_command_line, help_text, version_text

  !> What the user asked for.
  type :: command_line_t
    character(:), allocatable :: deck    !! path of the deck, empty if none is needed
    character(:), allocatable :: output  !! folder of the results, empty = beside the deck
    character(:), allocatable :: restart !! restart file to go on from, empty = begin anew
    integer :: threads = 0               !! OpenMP threads, 0 = default
    logical :: force = .false.           !! overwrite earlier results
    logical :: check = .false.           !! do not solve
    logical :: check_tangent = .false.   !! tangent against finite differences
    logical :: estimate = .false.        !! tell what a run needs, do not solve
    real(dp) :: max_memory = 0.0_dp      !! memory that a run may take [GB], 0 = any
    real(dp) :: publish = -1.0_dp        !! least time between publications [s], < 0: default
    integer, allocatable :: compare(:)   !! (n) formulation_* to run one after the other, or empty
    logical :: lax = .false.             !! what nothing uses is a warning
    logical :: quiet = .false.
    logical :: verbose = .false.
    logical :: schema = .false.          !! print the schema as JSON
    logical :: schema_markdown = .false. !! print the schema as tables of the manual
    logical :: version = .false.
    logical :: help = .false.
  end type command_line_t

  !> An option.
  type :: option_t
    character(1)  :: letter         !! short form, blank if none
    character(13) :: name           !! long form
    character(8)  :: value          !! what its value is, empty = none
    character(64) :: meaning        !! line of the help
  end type option_t

  type(option_t), parameter :: option(16) = [ &
    option_t("o", "output", "DIR", "where results go (default: beside the deck)"), &
    option_t("t", "threads", "N", "OpenMP threads (default: OMP_NUM_THREADS, else all)"), &
    option_t("f", "force", "", "overwrite earlier results of this job"), &
    option_t(" ", "check", "", "read, build, report, write increment 0, do not solve"), &
    option_t(" ", "check-tangent", "", "compare the tangent with finite differences, then stop"), &
    option_t(" ", "estimate", "", "tell memory, time and size of the results, do not solve"), &
    option_t(" ", "max-memory", "GB", "refuse a run that needs more memory"), &
    option_t(" ", "publish", "SECONDS", "least time between publications (default: 1)"), &
    option_t(" ", "compare", "LIST", "run the formulations of a list, as standard,fbar"), &
    option_t(" ", "restart", "FILE", "go on from a restart file"), &
    option_t(" ", "lax", "", "only warn of a set, material or amplitude that is not used"), &
    option_t("q", "quiet", "", "no progress"), &
    option_t("v", "verbose", "", "every Newton iteration on the terminal"), &
    option_t(" ", "schema", "[=FORM]", "print all keywords as json (default) or markdown"), &
    option_t(" ", "version", "", "print version, compiler and libraries"), &
    option_t("h", "help", "", "print this help")]

contains

  !> Takes the arguments of the program.
  subroutine get_arguments(arguments)
    character(:), allocatable, intent(out) :: arguments(:) !! (n) arguments, blanks behind
    integer :: i, length, longest

    longest = 1
    do i = 1, command_argument_count()
      call get_command_argument(i, length=length)
      longest = max(longest, length)
    end do
    allocate (character(longest) :: arguments(command_argument_count()))
    do i = 1, command_argument_count()
      call get_command_argument(i, arguments(i))
    end do
  end subroutine get_arguments

  !> Reads a command line.
  pure subroutine read_command_line(options, arguments, error)
    type(command_line_t), intent(out) :: options           !! what the user asked for
    character(*), intent(in) :: arguments(:)               !! (n) arguments, blanks behind
    type(error_t), allocatable, intent(out) :: error       !! wrong usage
    character(:), allocatable :: word
    logical :: only_files
    integer :: i

    options%deck = ""
    options%output = ""
    options%restart = ""
    allocate (options%compare(0))
    only_files = .false.
    i = 1
    do while (i <= size(arguments))
      word = trim(arguments(i))
      if (only_files .or. index(word, "-") /= 1) then
        call set_deck(options, word, error)
      else if (word == "--") then
        only_files = .true.
      else
        call read_option(options, arguments, i, error)
      end if
      if (allocated(error)) return
      i = i + 1
    end do
    call check_options(options, error)
  end subroutine read_command_line

  !> Takes the deck.
  pure subroutine set_deck(options, path, error)
    type(command_line_t), intent(inout) :: options   !! gets the deck
    character(*), intent(in) :: path                 !! argument without dash
    type(error_t), allocatable, intent(out) :: error !! a second deck, or an empty name

    if (len(path) == 0) then
      call usage_error(error, "empty argument: expected a deck")
    else if (len(options%deck) > 0) then
      call usage_error(error, "second deck '"//path//"': expected one")
    else
      options%deck = path
    end if
  end subroutine set_deck

  !> Reads an option and its value.
  pure subroutine read_option(options, arguments, i, error)
    type(command_line_t), intent(inout) :: options   !! gets the option
    character(*), intent(in) :: arguments(:)         !! (n) arguments
    integer, intent(inout)   :: i                    !! the option; on return its value
    type(error_t), allocatable, intent(out) :: error !! unknown option, wrong value
    character(:), allocatable :: name, value
    logical :: has_value
    integer :: k

    call split_option(trim(arguments(i)), name, value, has_value)
    k = find_option(name)
    if (k == 0) then
      call refuse_option(name, error)
      return
    end if
    name = "--"//trim(option(k)%name)
    if (len_trim(option(k)%value) == 0 .and. has_value) then
      call usage_error(error, name//" takes no value, found '"//value//"'")
    else if (index("[ ", option(k)%value(1:1)) == 0 .and. .not. has_value) then
      i = i + 1
      if (i <= size(arguments)) value = trim(arguments(i))
      has_value = i <= size(arguments)
      if (.not. has_value) call usage_error(error, name//" needs a value: expected "//name// &
                                            " "//trim(option(k)%value))
    end if
    if (allocated(error)) return
    if (len_trim(option(k)%value) > 0) then
      call set_value(options, trim(option(k)%name), value, has_value, error)
    else
      call set_flag(options, trim(option(k)%name))
    end if
  end subroutine read_option

  !> Takes an argument apart: `-o`, `-oDIR`, `--output`, `--output=DIR`.
  pure subroutine split_option(word, name, value, has_value)
    character(*), intent(in) :: word                    !! argument with a dash
    character(:), allocatable, intent(out) :: name      !! option with its dashes
    character(:), allocatable, intent(out) :: value     !! value, empty if none
    logical, intent(out) :: has_value                   !! a value is attached
    integer :: last

    if (index(word, "--") == 1) then
      last = index(word//"=", "=") - 1
      has_value = last < len(word)
      value = word(min(last + 2, len(word) + 1):)
    else
      last = len(word)
      if (index("ot", word(min(2, len(word)):min(2, len(word)))) > 0) last = 2
      has_value = last < len(word)
      value = word(last + 1:)
    end if
    name = word(:last)
  end subroutine split_option

  !> Position of an option in the table, 0 if it is unknown.
  pure integer function find_option(name)
    character(*), intent(in) :: name !! with its dashes

    do find_option = size(option), 1, -1
      if (name == "--"//option(find_option)%name) return
      if (option(find_option)%letter /= " " .and. name == "-"//option(find_option)%letter) return
    end do
  end function find_option

  !> Reports an unknown option.
  pure subroutine refuse_option(name, error)
    character(*), intent(in) :: name                 !! with its dashes
    type(error_t), allocatable, intent(out) :: error !! the report
    character(13) :: names(size(option))
    character(:), allocatable :: nearest

    names = option%name
    nearest = nearest_word(name(verify(name//"x", "-"):), names)
    if (len(nearest) > 0) then
      call usage_error(error, "unknown option '"//name//"': did you mean '--"//nearest//"'?")
    else
      call usage_error(error, "unknown option '"//name//"'")
    end if
  end subroutine refuse_option

  !> Sets an option without a value.
  pure subroutine set_flag(options, name)
    type(command_line_t), intent(inout) :: options !! gets the option
    character(*), intent(in) :: name               !! long name of an option of the table

    select case (name)
    case ("force")
      options%force = .true.
    case ("check")
      options%check = .true.
    case ("check-tangent")
      options%check_tangent = .true.
    case ("estimate")
      options%estimate = .true.
    case ("lax")
      options%lax = .true.
    case ("quiet")
      options%quiet = .true.
    case ("verbose")
      options%verbose = .true.
    case ("version")
      options%version = .true.
    case default
      options%help = .true.
    end select
  end subroutine set_flag

  !> Sets an option that has a value.
  pure subroutine set_value(options, name, value, has_value, error)
    type(command_line_t), intent(inout) :: options   !! gets the option
    character(*), intent(in) :: name                 !! long name of an option of the table
    character(*), intent(in) :: value                !! value, empty if none
    logical, intent(in) :: has_value                 !! .false.: only --schema
    type(error_t), allocatable, intent(out) :: error !! wrong value
    logical :: ok

    ok = .true.
    select case (name)
    case ("output")
      call check_first(len(options%output) == 0, name, error)
      if (len(value) == 0) call usage_error(error, "--output is empty: expected a folder")
      options%output = value
    case ("restart")
      call check_first(len(options%restart) == 0, name, error)
      if (len(value) == 0) call usage_error(error, "--restart is empty: expected a restart file")
      options%restart = value
    case ("threads")
      call check_first(options%threads == 0, name, error)
      if (allocated(error)) return
      call parse_integer(value, options%threads, ok)
      if (.not. ok .or. options%threads < 1) &
        call usage_error(error, "--threads is '"//value//"': expected an integer > 0")
    case ("max-memory")
      call check_first(options%max_memory <= 0.0_dp, name, error)
      if (allocated(error)) return
      call parse_real(value, options%max_memory, ok)
      if (.not. ok .or. .not. options%max_memory > 0.0_dp) &
        call usage_error(error, "--max-memory is '"//value//"': expected gigabytes, a number > 0")
    case ("publish")
      call check_first(options%publish < 0.0_dp, name, error)
      if (allocated(error)) return
      call parse_real(value, options%publish, ok)
      if (.not. ok .or. options%publish < 0.0_dp) &
        call usage_error(error, "--publish is '"//value//"': expected seconds, a number >= 0")
    case ("compare")
      call check_first(size(options%compare) == 0, name, error)
      if (allocated(error)) return
      call set_formulations(options, value, error)
    case default
      options%schema_markdown = value == "markdown"
      options%schema = .not. options%schema_markdown
      if (has_value .and. value /= "json" .and. value /= "markdown") &
        call usage_error(error, "--schema is '"//value//"': expected json or markdown")
    end select
  end subroutine set_value

  !> Refuses an option that was given before.
  pure subroutine check_first(is_first, name, error)
    logical, intent(in)      :: is_first             !! .false.: it was given before
    character(*), intent(in) :: name                 !! long name
    type(error_t), allocatable, intent(out) :: error !! the refusal

    if (.not. is_first) call usage_error(error, "--"//name//" is given twice: expected it once")
  end subroutine check_first

  !> Takes the formulations to compare.
  pure subroutine set_formulations(options, value, error)
    type(command_line_t), intent(inout) :: options   !! gets the formulations
    character(*), intent(in) :: value                !! names between commas
    type(error_t), allocatable, intent(out) :: error !! unknown name, or one twice
    integer, allocatable :: compare(:)
    integer :: first, last

    allocate (compare(0))
    first = 1
    do while (first <= len(value) + 1)
      last = first + index(value(first:)//",", ",") - 2
      select case (normalize_keyword(value(first:last)))
      case ("STANDARD")
        compare = [compare, formulation_standard]
      case ("FBAR", "FBAR PATCH")
        compare = [compare, formulation_fbar]
      case default
        compare = [compare, 0]
      end select
      first = last + 2
    end do
    if (size(compare) > 2 .or. any(compare == 0) .or. &
        (size(compare) == 2 .and. all(compare == compare(1)))) &
      call usage_error(error, "--compare is '"//value//"': expected standard,fbar or one of them")
    call move_alloc(compare, options%compare)
  end subroutine set_formulations

  !> Checks that the options fit together.
  pure subroutine check_options(options, error)
    type(command_line_t), intent(in) :: options      !! all options
    type(error_t), allocatable, intent(out) :: error !! what does not fit

    if (options%help .or. options%version) return
    if (options%schema .or. options%schema_markdown) return
    if (len(options%deck) == 0) then
      call usage_error(error, "no deck: expected tessera JOB.inp")
    else if (options%quiet .and. options%verbose) then
      call usage_error(error, "--quiet and --verbose: expected one of them")
    else if (len(options%restart) > 0 .and. size(options%compare) > 1) then
      call usage_error(error, "--restart goes on with one run: expected one formulation in --compare")
    else
      call check_task(options, error)
    end if
  end subroutine check_options

  !> Checks that there is one task, and that what goes with a run goes with it.
  pure subroutine check_task(options, error)
    type(command_line_t), intent(in) :: options      !! all options
    type(error_t), allocatable, intent(out) :: error !! what does not fit
    character(15), parameter :: name(3) = [character(15) :: "check", "check-tangent", "estimate"]
    character(:), allocatable :: first, other
    logical :: asked(3)

    asked = [options%check, options%check_tangent, options%estimate]
    if (.not. any(asked)) return
    first = "--"//trim(name(findloc(asked, .true., dim=1)))
    other = ""
    if (count(asked) > 1) then
      other = first
      first = "--"//trim(name(findloc(asked, .true., dim=1, back=.true.)))
    else if (len(options%restart) > 0 .and. .not. options%check) then
      other = "--restart"
    else if (options%max_memory > 0.0_dp .and. options%check_tangent) then
      other = "--max-memory"
    end if
    if (len(other) == 0) return
    call usage_error(error, other//" and "//first//": expected one of them")
  end subroutine check_task

  !> Makes an error of wrong usage.
  pure subroutine usage_error(error, message)
    type(error_t), allocatable, intent(out) :: error !! the error
    character(*), intent(in) :: message              !! what is wrong and what was expected

    call make_error(error, exit_usage, "tessera: error: "//message//new_line("a")// &
                    "tessera --help lists the options")
  end subroutine usage_error

  !> Text of `--help`.
  pure function help_text() result(text)
    character(:), allocatable :: text
    character(28) :: form
    integer :: i

    text = "usage: tessera [options] JOB.inp"//new_line("a")//new_line("a")// &
           "Material point method on simplex meshes with F-bar patches."//new_line("a")
    do i = 1, size(option)
      form = "      --"//trim(option(i)%name)
      if (option(i)%letter /= " ") form(3:5) = "-"//option(i)%letter//","
      if (option(i)%value(1:1) /= "[") form = trim(form)//" "//option(i)%value
      if (option(i)%value(1:1) == "[") form = trim(form)//option(i)%value
      text = text//new_line("a")//form//trim(option(i)%meaning)
    end do
    text = text//new_line("a")//new_line("a")// &
           "exit code: 0 done, 1 usage, 2 deck, 3 mesh or model, 4 no convergence, 5 solver or"// &
           new_line("a")//"memory, 6 point lost, 7 *EXPECT failed, 8 file, 130 or 143 interrupted"
  end function help_text

  !> Text of `--version`.
  pure function version_text() result(text)
    character(:), allocatable :: text

    text = "tessera "//version//" ("//git_revision//", "//build_type//")"//new_line("a")// &
           compiler//", "//library_text()
  end function version_text

end module mpm_command_line
