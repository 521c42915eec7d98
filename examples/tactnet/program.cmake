# tactnet_add_program(target
#     NETWORKS network… [SIZES size…] [TRUNKS trunk…] [CLASSES number] [EIGHT_BIT network…]
#     [HEADER file NAMESPACE namespace])
#
# The program `tactnet` with these networks: a unit is compiled for each network at each of the sizes (28x50), or at its
# own as in tactnet4=28x50,7x13. TRUNKS are networks trained on photographs that methods begin with, at all sizes.
# Networks are the library's, or templates of a header of one's own, `namespace::network<input, classes>`, where a - in a
# name stands for a _. EIGHT_BIT are those of them that are compiled in 8 bits too, at all their sizes or as in
# tactnet4=28x50, each in a unit of its own. The property TACTNET_UNITS of the target tells what was compiled, as
# network_size and network_size_in_8_bits.
#
# The target <target>_code_bytes, which no other builds, compiles what recognises a frame of each network alone and writes
# how many bytes that takes beside the weights, to <target>_code_bytes.csv beside the program.

find_program(TACTNET_SIZE NAMES size llvm-size DOC "tells the bytes of object files")
mark_as_advanced(TACTNET_SIZE)

# Sets <rows> and <columns> of a size.
macro(tactnet_split_size size)
    if(NOT "${size}" MATCHES "^([1-9][0-9]*)x([1-9][0-9]*)$")
        message(FATAL_ERROR "tactnet_add_program: expected sizes such as 28x50, found '${size}'.")
    endif()
    set(rows "${CMAKE_MATCH_1}")
    set(columns "${CMAKE_MATCH_2}")
endmacro()

function(tactnet_add_program target)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "CLASSES;HEADER;NAMESPACE" "NETWORKS;SIZES;TRUNKS;EIGHT_BIT")
    if(arg_UNPARSED_ARGUMENTS OR NOT arg_NETWORKS)
        message(FATAL_ERROR "tactnet_add_program: expected NETWORKS and other keywords, found '${arg_UNPARSED_ARGUMENTS}'.")
    endif()
    get_property(templates GLOBAL PROPERTY TACTNET_PROGRAM_SOURCE_DIR)
    set(units_dir "${CMAKE_CURRENT_BINARY_DIR}/${target}_units")
    set(program_classes "${arg_CLASSES}")
    if(NOT program_classes)
        set(program_classes 22)
    endif()
    set(namespace tactnet)
    set(own_include "")
    if(arg_HEADER AND NOT arg_NAMESPACE)
        message(FATAL_ERROR "tactnet_add_program: expected NAMESPACE, in which HEADER has the networks.")
    endif()
    if(arg_HEADER)
        get_filename_component(header "${arg_HEADER}" ABSOLUTE)
        set(own_include "#include \"${header}\"\n")
        set(namespace "${arg_NAMESPACE}")
    endif()

    # Those in 8 bits, as network or network_size.
    set(eight_bit "")
    foreach(entry IN LISTS arg_EIGHT_BIT)
        if(NOT entry MATCHES "^([^=]+)(=(.+))?$")
            message(FATAL_ERROR "tactnet_add_program: expected EIGHT_BIT network or network=size,size, found '${entry}'.")
        endif()
        set(network "${CMAKE_MATCH_1}")
        string(REPLACE "," ";" sizes "${CMAKE_MATCH_3}")
        if(NOT sizes)
            list(APPEND eight_bit "${network}")
        endif()
        foreach(size IN LISTS sizes)
            tactnet_split_size("${size}")
            list(APPEND eight_bit "${network}_${size}")
        endforeach()
    endforeach()

    set(unit_sources "")
    set(frame_sources "")
    set(frame_networks "")
    set(all_unit_declarations "")
    set(unit_calls "")
    set(all_units "")
    set(all_sizes "")
    foreach(entry IN LISTS arg_NETWORKS)
        if(NOT entry MATCHES "^([^=]+)(=(.+))?$")
            message(FATAL_ERROR "tactnet_add_program: expected a network or network=size,size, found '${entry}'.")
        endif()
        set(network "${CMAKE_MATCH_1}")
        string(REPLACE "," ";" sizes "${CMAKE_MATCH_3}")
        if(NOT sizes)
            set(sizes "${arg_SIZES}")
        endif()
        if(NOT sizes)
            message(FATAL_ERROR "tactnet_add_program: expected sizes of ${network}, as ${network}=28x50 or by SIZES.")
        endif()
        string(MAKE_C_IDENTIFIER "${network}" alias)
        set(qualified "${namespace}::${alias}")
        # Those that begin with weights learnt from photographs.
        if(network MATCHES "-nn$")
            set(family of_photographs)
            set(unit_includes
                "#include <tactnet/transfer/as_photograph.hpp>\n#include <tactnet/transfer/networks.hpp>\n"
            )
        else()
            set(family of_touches)
            set(unit_includes "#include <tactnet/networks.hpp>\n")
        endif()
        string(APPEND unit_includes "${own_include}")
        foreach(size IN LISTS sizes)
            tactnet_split_size("${size}")
            set(training "std::nullopt")
            if(NOT arg_HEADER)
                set(training "${qualified}_training({${rows}, ${columns}})")
            endif()
            set(unit "${alias}_${size}")
            # Two forms of a network may be the same type at a size: the unit asks the compiler.
            set(unit_declarations "std::unique_ptr<compiled_network> make_${unit}();\n")
            set(unit_twins "")
            foreach(twin IN LISTS twins_${family}_${size})
                string(APPEND unit_declarations "std::unique_ptr<compiled_network> make_${twin}_${size}();\n")
                string(APPEND unit_twins
                       "    if constexpr (std::is_same_v<Network, ${namespace}::${twin}<input, classes>>)\n"
                       "        return make_${twin}_${size}();\n    else\n"
                )
            endforeach()
            set(source "${units_dir}/${unit}.cpp")
            configure_file("${templates}/methods/networks/unit.cpp.in" "${source}" @ONLY)
            list(APPEND twins_${family}_${size} "${alias}")
            list(APPEND unit_sources "${source}")
            list(APPEND all_units "${network}_${size}")
            list(APPEND all_sizes "${size}")
            string(APPEND all_unit_declarations "std::unique_ptr<compiled_network> make_${unit}();\n")
            set(bytes nullptr)
            set(format single_precision)
            set(eight_bit_include "")
            configure_file("${templates}/methods/networks/frame.cpp.in" "${units_dir}/frames/${unit}.cpp" @ONLY)
            list(APPEND frame_sources "${units_dir}/frames/${unit}.cpp")
            list(APPEND frame_networks "${network}/${size},32")
            if("${network}" IN_LIST eight_bit OR "${network}_${size}" IN_LIST eight_bit)
                set(source "${units_dir}/${unit}_in_8_bits.cpp")
                configure_file("${templates}/methods/networks/eight_bit/unit.cpp.in" "${source}" @ONLY)
                list(APPEND unit_sources "${source}")
                set(format eight_bit)
                set(eight_bit_include "#include <tactnet/deployment/eight_bit.hpp>\n")
                set(frame "${units_dir}/frames/${unit}_in_8_bits.cpp")
                configure_file("${templates}/methods/networks/frame.cpp.in" "${frame}" @ONLY)
                list(APPEND frame_sources "${frame}")
                list(APPEND frame_networks "${network}/${size},8")
                list(APPEND all_units "${network}_${size}_in_8_bits")
                set(bytes "make_eight_bit_${unit}()")
                string(APPEND all_unit_declarations "std::unique_ptr<compiled_eight_bit> ${bytes};\n")
            endif()
            string(APPEND unit_calls
                   "    list.push_back(make_network_method(\"${network}\", make_${unit}(), \"${qualified}\", ${training},\n"
                   "                                       ${bytes}));\n"
            )
        endforeach()
    endforeach()
    # Behind the networks, heads and support vector machines for images of each size.
    list(REMOVE_DUPLICATES all_sizes)
    foreach(size IN LISTS all_sizes)
        tactnet_split_size("${size}")
        set(source "${units_dir}/surf_${size}.cpp")
        configure_file("${templates}/methods/support_vector_machines/surf_unit.cpp.in" "${source}" @ONLY)
        list(APPEND unit_sources "${source}")
        string(APPEND all_unit_declarations "std::vector<std::unique_ptr<method>> make_svm_methods_${size}();\n")
        string(APPEND unit_calls
               "    for (auto& svm : make_svm_methods_${size}())\n        list.push_back(std::move(svm));\n"
               "    for (auto& svm : make_trunk_svm_methods(${rows}, ${columns}, trunks))\n"
               "        list.push_back(std::move(svm));\n"
               "    for (auto& head : make_trunk_head_methods(${rows}, ${columns}, trunks))\n"
               "        list.push_back(std::move(head));\n"
        )
    endforeach()
    # Trunks take photographs, which images of all sizes become: a unit each.
    set(trunk_calls "")
    foreach(trunk IN LISTS arg_TRUNKS)
        if(NOT trunk MATCHES "^[a-z0-9]+$")
            message(FATAL_ERROR "tactnet_add_program: expected trunks such as squeezenet, found '${trunk}'.")
        endif()
        set(source "${units_dir}/trunk_${trunk}.cpp")
        configure_file("${templates}/methods/trunks/unit.cpp.in" "${source}" @ONLY)
        list(APPEND unit_sources "${source}")
        string(APPEND all_unit_declarations "std::shared_ptr<const compiled_trunk> make_trunk_${trunk}();\n")
        list(APPEND trunk_calls "make_trunk_${trunk}()")
    endforeach()
    list(JOIN trunk_calls ", " trunk_calls)
    set(unit_declarations "${all_unit_declarations}")
    configure_file("${templates}/methods/method_list.cpp.in" "${units_dir}/method_list.cpp" @ONLY)

    add_library(${target}_units OBJECT ${unit_sources})
    add_executable(
        ${target} $<TARGET_OBJECTS:tactnet_program_commands> $<TARGET_OBJECTS:tactnet_program_scenes>
                  $<TARGET_OBJECTS:${target}_units>
                  "${units_dir}/method_list.cpp"
    )
    foreach(part IN ITEMS ${target}_units ${target})
        tactnet_use(${part})
        target_link_libraries(${part} PRIVATE tactnet_program_parts)
    endforeach()
    target_link_libraries(${target} PRIVATE tactnet::simulation tactnet_quick_to_compile)
    if(TACTNET_SIZE)
        add_library(${target}_frames OBJECT EXCLUDE_FROM_ALL ${frame_sources})
        tactnet_use(${target}_frames)
        set_target_properties(${target}_frames PROPERTIES UNITY_BUILD OFF)
        add_custom_target(
            ${target}_code_bytes
            COMMAND
                "${CMAKE_COMMAND}" "-DSIZE=${TACTNET_SIZE}" "-DNETWORKS=${frame_networks}"
                "-DOBJECTS=$<TARGET_OBJECTS:${target}_frames>"
                "-DOUTPUT=$<TARGET_FILE_DIR:${target}>/${target}_code_bytes.csv" -P
                "${templates}/methods/networks/code_bytes.cmake"
            DEPENDS $<TARGET_OBJECTS:${target}_frames>
            VERBATIM
        )
    endif()
    set_target_properties(${target} PROPERTIES TACTNET_UNITS "${all_units}")
endfunction()
