# Units for different instruction sets in one program: as compiled, they share no name of the library; as linked, each
# shows one name and no more, so that neither do they share what templates of the standard library became.
#
# cmake -DNM=nm "-DUNITS=<linked object>=<compiled object>;..." -P several_processors.cmake
cmake_minimum_required(VERSION 3.22)

# Names that a unit defines and others see.
function(names_of object variable)
    execute_process(
        COMMAND "${NM}" --defined-only --extern-only --format=posix "${object}"
        OUTPUT_VARIABLE output COMMAND_ERROR_IS_FATAL ANY
    )
    string(REGEX MATCHALL "[^\n]+" lines "${output}")
    list(TRANSFORM lines REPLACE " .*" "")
    set(${variable} "${lines}" PARENT_SCOPE)
endfunction()

set(seen "")
set(count 0)
foreach(unit IN LISTS UNITS)
    if(unit STREQUAL "")
        continue()
    endif()
    string(REGEX MATCH "^(.*)=(.*)$" unit "${unit}")
    set(linked "${CMAKE_MATCH_1}")
    set(compiled "${CMAKE_MATCH_2}")
    names_of("${linked}" names)
    list(LENGTH names number)
    if(NOT number EQUAL 1 OR NOT names MATCHES "^recogniser_[a-z0-9]+$")
        message(FATAL_ERROR "${linked}: expected one name, recogniser_..., found ${names}")
    endif()
    names_of("${compiled}" names)
    list(FILTER names INCLUDE REGEX "tactnet")
    if(NOT names)
        message(FATAL_ERROR "${compiled}: expected names of the library, found none: this would prove nothing")
    endif()
    foreach(name IN LISTS names)
        if(name IN_LIST seen)
            message(FATAL_ERROR "${compiled}: another unit has ${name} too")
        endif()
    endforeach()
    list(APPEND seen ${names})
    math(EXPR count "${count} + 1")
endforeach()
if(count LESS 2)
    message(FATAL_ERROR "expected several units, found ${count}")
endif()
