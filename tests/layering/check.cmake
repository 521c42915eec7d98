# Checks that the arrows between the library's rooms point one way.
#
# cmake -DROOT=<folder that holds tactnet/> -P check.cmake
# cmake -DROOT=… -DPICTURES=<docs/pictures> -P check.cmake    checks the pictures of the rooms instead
cmake_minimum_required(VERSION 3.22)
get_filename_component(ROOT "${ROOT}" ABSOLUTE)

# What each room may include, apart from itself, detail and the version.
set(room_detail "")
set(room_version "")
set(room_tensor "")
set(room_text "")
set(room_runtime tensor)
set(room_kernels runtime tensor)
set(room_layers kernels runtime tensor)
set(room_networks layers kernels runtime tensor)
set(room_deployment networks layers kernels runtime tensor)
set(room_quantisation deployment networks layers kernels runtime tensor)
set(room_decision networks layers kernels runtime tensor)
set(room_training text image networks layers kernels runtime tensor)
set(room_image kernels runtime tensor)
set(room_transfer io text deployment image networks layers kernels runtime tensor)
set(room_svm text kernels runtime tensor)
set(room_features text kernels runtime tensor)
set(room_io text kernels runtime tensor) # io/parameters.hpp and others take a network as a template argument and include none
set(header_io/model_file.hpp networks) # what this one may include in addition: it is the file of a networks/model.hpp
set(room_sensors io text tensor)
# Of io only what needs nothing but the standard library, as sensors must work without any other.
set(only_sensors_io file_error read_file)
set(header_io/svm_file.hpp svm)
set(header_io/deployed_file.hpp deployment networks)
set(header_io/eight_bit_file.hpp deployment networks)
set(header_io/stored_deployed.hpp deployment)
set(room_eigen text tensor sensors svm)
# Only what has frames and rows in it, which needs nothing but tensors.
set(only_eigen_sensors frame)
set(only_eigen_svm feature_rows)
set(room_simulation sensors text image kernels runtime tensor)
set(only_simulation_sensors tekscan_6077) # what sensors there are, not what they send
set(room_forward tensor)
# The core umbrella: a user of inference never pays for training.
set(room_tactnet forward tensor layers networks deployment)

# What the folders of kernels/ may include of each other. What a deployed network runs includes nothing that only
# trainings need.
set(folder_kernels/simd "")
foreach(folder IN ITEMS batch integer map panels)
    set(folder_kernels/${folder} simd)
endforeach()
set(folder_kernels/frame panels simd)
set(folder_kernels/rows panels simd)
set(folder_kernels simd) # headers next to the folders

# Folders that only these and they themselves include: a simulation of your own objects does not pay for
# the paper's 22 classes.
set(closed_folders simulation/paper)
set(users_of_simulation/paper simulation.hpp)

# What only kernels/ may know.
set(kernel_headers "^xsimd/|^(immintrin|x86intrin|arm_acle|arm_neon|arm_sve|wasm_simd128)\\.h$")
# What may include Eigen, apart from the room eigen: programs that include none of it need no Eigen.
set(eigen_users simulation/effects/circuit/resistive_network.hpp)
# What the standard library leaves to the system: files that are safe on disk, an interrupt from the keyboard.
set(system_headers "^(unistd|fcntl|io|windows)\\.h$|^sys/[a-z]+\\.h$")

set(problems "")
macro(problem text)
    string(APPEND problems "  ${text}\n")
endmacro()

if(PICTURES)
    include("${CMAKE_CURRENT_LIST_DIR}/picture.cmake")
    return()
endif()

file(GLOB_RECURSE headers RELATIVE "${ROOT}/tactnet" "${ROOT}/tactnet/*")
if(NOT headers)
    message(FATAL_ERROR "There are no headers in ${ROOT}/tactnet.")
endif()
list(SORT headers)

foreach(header IN LISTS headers)
    # A room is a folder; an umbrella <room>.hpp next to the folders belongs to the room.
    string(REGEX REPLACE "/.*|\\.hpp$" "" room "${header}")
    if(NOT DEFINED room_${room})
        problem("${header}: there is no room '${room}'; give it its place in tests/layering/check.cmake")
        continue()
    endif()

    file(READ "${ROOT}/tactnet/${header}" text)
    if(NOT text MATCHES "(^|\n)#pragma once\n")
        problem("${header}: has no '#pragma once'")
    endif()
    if(text MATCHES "^#pragma once\n+//[^\n]*\n(//[^\n]*\n)*\n+#include")
        problem("${header}: has its comment in front of its includes, not behind them")
    endif()
    # Brackets and semicolons mean something to CMake's lists, not here.
    string(REGEX REPLACE "[][;]" " " text "${text}")
    string(REPLACE "\n" ";" lines "${text}")
    set(number 0)
    foreach(line IN LISTS lines)
        math(EXPR number "${number} + 1")
        set(place "${header}:${number}")
        if(line MATCHES "^ *namespace tactnet" AND NOT line MATCHES "^namespace tactnet { inline namespace TACTNET_ARCH {")
            problem("${place}: opens namespace tactnet without 'inline namespace TACTNET_ARCH {' behind it")
        elseif(line MATCHES "^ *# *include +\"")
            problem("${place}: public headers include by angle brackets, found ${line}")
        elseif(line MATCHES "^ *# *include +<([^>]*)>")
            set(included "${CMAKE_MATCH_1}")
            if(included MATCHES "^tactnet/(.*)$")
                string(REGEX REPLACE "/.*|\\.hpp$" "" target "${CMAKE_MATCH_1}")
                if(NOT DEFINED room_${target})
                    problem("${place}: <${included}> is in no room")
                elseif(
                    NOT target IN_LIST room_${room}
                    AND NOT target IN_LIST header_${header}
                    AND NOT target MATCHES "^(${room}|detail|version)$"
                )
                    problem("${place}: room '${room}' may not include <${included}>")
                elseif(DEFINED only_${room}_${target})
                    string(REGEX REPLACE "^tactnet/[a-z_]+/|\\.hpp$" "" part "${included}")
                    if(NOT part IN_LIST only_${room}_${target})
                        problem("${place}: room '${room}' may not include <${included}>")
                    endif()
                endif()
                if(room STREQUAL "kernels" AND included MATCHES "^tactnet/kernels/([a-z_]+)/")
                    set(target "${CMAKE_MATCH_1}")
                    get_filename_component(folder "${header}" DIRECTORY)
                    string(REGEX REPLACE "^(kernels/[a-z_]+)/.*" "\\1" folder "${folder}")
                    if(NOT folder STREQUAL "kernels/${target}" AND NOT target IN_LIST folder_${folder})
                        problem("${place}: '${folder}' may not include <${included}>")
                    endif()
                endif()
                foreach(folder IN LISTS closed_folders)
                    if(included MATCHES "^tactnet/${folder}/" AND NOT header MATCHES "^${folder}/"
                       AND NOT header IN_LIST users_of_${folder}
                    )
                        problem("${place}: only ${folder}/ and ${users_of_${folder}} may include <${included}>")
                    endif()
                endforeach()
            elseif(included MATCHES "${kernel_headers}")
                if(NOT room STREQUAL "kernels")
                    problem("${place}: only kernels/ may include <${included}>")
                endif()
            elseif(included MATCHES "^(Eigen|unsupported)/")
                if(NOT room STREQUAL "eigen" AND NOT header IN_LIST eigen_users)
                    problem("${place}: only eigen/ and ${eigen_users} may include <${included}>")
                endif()
            elseif(included MATCHES "[./]" AND NOT included MATCHES "${system_headers}")
                problem("${place}: <${included}> is neither the library's nor the standard's, nor Eigen or xsimd")
            endif()
        elseif(line MATCHES "(random_purpose|effect_purpose) ([a-z_]+){([0-9]+)}")
            # Two purposes with one number would draw the same numbers.
            set(taken "${CMAKE_MATCH_1}_${CMAKE_MATCH_3}")
            if(DEFINED place_of_${taken})
                problem("${place}: the number of ${CMAKE_MATCH_2} is that of ${place_of_${taken}}")
            endif()
            set(place_of_${taken} "${place}")
        endif()
    endforeach()
endforeach()

if(problems)
    message(FATAL_ERROR "The arrows between the rooms point one way (see docs/contribute/rooms.md):\n${problems}")
endif()
list(LENGTH headers count)
message("${count} headers, every include points the right way")
