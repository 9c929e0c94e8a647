# kinship_manual(PROGRAM SECTION [COMPONENT name])
#
# Asks a program for its manual page and completions, into ${CMAKE_BINARY_DIR}/share as they are installed; installs them
# with the component of the program, if it is installed itself.
add_custom_target(manual ALL)
function(kinship_manual program section)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "COMPONENT" "")
  set(share ${CMAKE_BINARY_DIR}/share)
  set(made)
  foreach(place IN ITEMS "man/man${section}/${program}.${section}|--man-page"
          "bash-completion/completions/${program}|--completion=bash"
          "zsh/vendor-completions/_${program}|--completion=zsh"
          "fish/vendor_completions.d/${program}.fish|--completion=fish")
    string(REPLACE "|" ";" place ${place})
    list(GET place 0 file)
    list(GET place 1 option)
    cmake_path(GET file PARENT_PATH folder)
    file(MAKE_DIRECTORY ${share}/${folder})
    add_custom_command(OUTPUT ${share}/${file} DEPENDS ${program} VERBATIM
      COMMAND sh -c "\"$1\" $2 > \"$3\"" -- $<TARGET_FILE:${program}> ${option} ${share}/${file})
    list(APPEND made ${share}/${file})
    if(arg_COMPONENT)
      install(FILES ${share}/${file} DESTINATION ${CMAKE_INSTALL_DATADIR}/${folder} COMPONENT ${arg_COMPONENT})
    endif()
  endforeach()
  add_custom_target(manual_of_${program} DEPENDS ${made})
  add_dependencies(manual manual_of_${program})
endfunction()
