# The bytes of machine code and constants in object files, as a table that `tactnet study --code-bytes` takes:
#
#   cmake -DSIZE=size -DNETWORKS=tactnet6/28x50,32;… -DOBJECTS=file;… -DOUTPUT=table.csv -P code_bytes.cmake

cmake_minimum_required(VERSION 3.22)
set(table "network,bits,bytes\n")
foreach(network object IN ZIP_LISTS NETWORKS OBJECTS)
    # Sources and objects stand in the same order; a name that is not the network's would show otherwise.
    string(REGEX MATCH "^([^/]+)/([^,]+),([0-9]+)$" parts "${network}")
    string(REPLACE "-" "_" unit "${CMAKE_MATCH_1}_${CMAKE_MATCH_2}")
    if(CMAKE_MATCH_3 EQUAL 8)
        string(APPEND unit "_in_8_bits")
    endif()
    get_filename_component(name "${object}" NAME)
    if(NOT parts OR NOT name MATCHES "^${unit}\\.")
        message(FATAL_ERROR "expected the object file of '${network}', found '${object}'.")
    endif()
    execute_process(COMMAND "${SIZE}" "${object}" OUTPUT_VARIABLE said RESULT_VARIABLE failed)
    # The first column of the second line: code, constants, and what exceptions need.
    if(failed OR NOT said MATCHES "\n *([0-9]+)")
        message(FATAL_ERROR "${SIZE}: expected the sizes of ${object}, found '${said}'.")
    endif()
    string(APPEND table "${network},${CMAKE_MATCH_1}\n")
endforeach()
file(WRITE "${OUTPUT}" "${table}")
message(STATUS "${OUTPUT}")
