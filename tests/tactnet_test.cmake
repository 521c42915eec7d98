find_package(doctest REQUIRED)

# tactnet_test(room SOURCES file... [LIBRARIES target...] [TIMEOUT seconds])
#
# One program test_<room> and one entry in CTest. A program in which no test case is left fails, rather than passing
# because nothing was wrong.
function(tactnet_test room)
    cmake_parse_arguments(PARSE_ARGV 1 test "" "TIMEOUT" "SOURCES;LIBRARIES")
    if(test_UNPARSED_ARGUMENTS OR NOT test_SOURCES)
        message(FATAL_ERROR "tactnet_test(${room}): expected SOURCES file..., found '${ARGN}'.")
    endif()
    if(NOT test_TIMEOUT)
        set(test_TIMEOUT 600)
    endif()
    add_executable(test_${room} ${test_SOURCES})
    tactnet_use(test_${room})
    target_include_directories(test_${room} PRIVATE "${CMAKE_CURRENT_SOURCE_DIR}")
    target_link_libraries(test_${room} PRIVATE tactnet_test_main ${test_LIBRARIES})
    add_test(NAME ${room} COMMAND test_${room})
    set_tests_properties(
        ${room} PROPERTIES TIMEOUT ${test_TIMEOUT} FAIL_REGULAR_EXPRESSION "test cases: +0 "
    )
endfunction()
