# tactnet_add_program(target
#     NETWORKS network… [SIZES size…] [TRUNKS trunk…] [CLASSES number] [EIGHT_BIT network…]
#     [HEADER file NAMESPACE namespace])
#
# The program `tactnet` with these networks, each compiled for each of the SIZES (28x50), or for sizes of its own as in
# tactnet4=28x50,7x13; in every list commas and semicolons mean the same. EIGHT_BIT are those that are compiled in 8 bits
# too. TRUNKS are networks trained on photographs that methods begin with, at all sizes. Networks are the library's, or
# templates of your own header, `namespace::network<input, classes>`, where a - in a name stands for a _. The property
# TACTNET_UNITS of the target lists what was compiled, as network_size and network_size_in_8_bits.

# Sets `result` to network_size for each network and size.
function(tactnet_networks_at_sizes result entries sizes)
    string(REPLACE "," ";" entries "${entries}")
    set(list "")
    foreach(entry IN LISTS entries)
        set(own "${entry}") # one more size of the network before it
        if(entry MATCHES "^([a-z][a-z0-9_-]*)(=(.*))?$")
            set(network "${CMAKE_MATCH_1}")
            set(own "${CMAKE_MATCH_3}")
            if(NOT CMAKE_MATCH_2)
                set(own "${sizes}")
            endif()
        endif()
        string(REPLACE "," ";" own "${own}")
        foreach(size IN LISTS own)
            if(NOT network OR NOT size MATCHES "^[1-9][0-9]*x[1-9][0-9]*$")
                message(FATAL_ERROR "tactnet_add_program: expected a network or network=28x50,7x13, found '${entry}' (${size}).")
            endif()
            list(APPEND list "${network}_${size}")
        endforeach()
        if(NOT own)
            message(FATAL_ERROR "tactnet_add_program: expected sizes of ${network}, as ${network}=28x50 or by SIZES.")
        endif()
    endforeach()
    set(${result} "${list}" PARENT_SCOPE)
endfunction()

# A source of tactnet_add_program, which defines make_<name>() of that type: it returns the expression.
macro(tactnet_add_unit name headers type expression)
    set(function "${type} make_${name}()")
    file(CONFIGURE OUTPUT "${folder}/${name}.cpp" CONTENT "// Generated.\n${headers}\n${function};\n\n${function} {
    return ${expression};\n}\n" @ONLY)
    string(APPEND functions "${function};\n")
    list(APPEND sources "${folder}/${name}.cpp")
endmacro()

function(tactnet_add_program target)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "CLASSES;HEADER;NAMESPACE" "NETWORKS;SIZES;TRUNKS;EIGHT_BIT")
    if(arg_UNPARSED_ARGUMENTS OR NOT arg_NETWORKS OR (arg_HEADER AND NOT arg_NAMESPACE))
        message(FATAL_ERROR "tactnet_add_program: expected NETWORKS, and NAMESPACE with HEADER, found '${ARGN}'.")
    endif()
    tactnet_networks_at_sizes(networks "${arg_NETWORKS}" "${arg_SIZES}")
    list(TRANSFORM networks REPLACE ".*_" "" OUTPUT_VARIABLE all_sizes)
    list(REMOVE_DUPLICATES all_sizes)
    tactnet_networks_at_sizes(eight_bit "${arg_EIGHT_BIT}" "${all_sizes}")
    string(REPLACE "," ";" trunks "${arg_TRUNKS}")
    set(classes 22)
    if(arg_CLASSES)
        set(classes "${arg_CLASSES}")
    endif()
    set(namespace tactnet)
    if(arg_HEADER)
        set(namespace "${arg_NAMESPACE}")
        get_filename_component(header "${arg_HEADER}" ABSOLUTE)
    endif()
    set(folder "${CMAKE_CURRENT_BINARY_DIR}/${target}_units")
    set(sources "") # not those of the caller

    foreach(unit IN LISTS networks)
        string(REGEX MATCH "^(.*)_(([0-9]+)x([0-9]+))$" unit "${unit}")
        set(network "${CMAKE_MATCH_1}")
        set(size "${CMAKE_MATCH_2}")
        set(extents "${CMAKE_MATCH_3}, ${CMAKE_MATCH_4}")
        string(MAKE_C_IDENTIFIER "${network}" alias)
        set(template "${namespace}::${alias}")
        set(type "${template}<tactnet::shape{${extents}, 1}, ${classes}>")
        set(headers "#include <tactnet/networks.hpp>\n")
        set(training "${template}_training({${extents}})")
        if(network MATCHES "-nn$") # begins with weights learnt from photographs
            set(headers "#include <tactnet/transfer/as_photograph.hpp>\n#include <tactnet/transfer/networks.hpp>\n")
        endif()
        if(arg_HEADER)
            string(APPEND headers "#include \"${header}\"\n")
            set(training std::nullopt)
        endif()
        set(name "${alias}_${size}")
        tactnet_add_unit("${name}" "#include \"methods/networks/compile.hpp\"\n${headers}" compiled_network
            "compile_network<${type}, ${template}<tactnet::shape{${extents}, 1}, 1>>()")
        list(APPEND compiled "${unit}")
        set(bytes nullptr)
        if("${unit}" IN_LIST eight_bit)
            set(bytes "make_${name}_in_8_bits()")
            tactnet_add_unit("${name}_in_8_bits" "#include \"methods/networks/compile_eight_bit.hpp\"\n${headers}"
                "std::unique_ptr<compiled_eight_bit>" "std::make_unique<eight_bit_code<${type}>>()")
            list(APPEND compiled "${unit}_in_8_bits")
        endif()
        string(APPEND calls "\n    methods.push_back(make_network_method(\"${network}\", make_${name}(), \"${template}\", ${training}, ${bytes}));")
    endforeach()
    # After the networks: support vector machines for images of each size.
    foreach(size IN LISTS all_sizes)
        string(REPLACE "x" ", " extents "${size}")
        tactnet_add_unit("surf_${size}" "#include \"methods/support_vector_machines/surf_features.hpp\"\n"
            "std::unique_ptr<image_features>" "std::make_unique<surf_features<tactnet::shape{${extents}}>>()")
        string(APPEND calls "\n    add_methods_on_features(methods, {${extents}}, make_surf_${size}, trunks);")
    endforeach()
    # Trunks take photographs, which images of all sizes become.
    foreach(trunk IN LISTS trunks)
        tactnet_add_unit("trunk_${trunk}" "#include \"methods/trunks/compile.hpp\"\n" "std::shared_ptr<const compiled_trunk>"
            "compile_trunk<trunks::${trunk}>()")
        string(APPEND trunk_calls "make_trunk_${trunk}(), ")
    endforeach()
    file(CONFIGURE OUTPUT "${folder}/method_list.cpp" CONTENT "// Generated: all methods that were compiled in.
#include \"methods/networks/compiled.hpp\"\n#include \"methods/registry.hpp\"
#include \"methods/support_vector_machines/features.hpp\"\n#include \"methods/trunks/compiled.hpp\"\n
#include <tactnet/networks.hpp>\n#include <tactnet/transfer/networks.hpp>\n\n${functions}
std::vector<std::unique_ptr<method>> make_methods() {
    const std::vector<std::shared_ptr<const compiled_trunk>> trunks{${trunk_calls}};
    std::vector<std::unique_ptr<method>> methods;${calls}
    return methods;\n}\n" @ONLY)

    add_library(${target}_units OBJECT ${sources})
    add_executable(${target} $<TARGET_OBJECTS:tactnet_program_commands> $<TARGET_OBJECTS:${target}_units>
        "${folder}/method_list.cpp")
    foreach(part IN ITEMS ${target}_units ${target})
        tactnet_use(${part})
        target_link_libraries(${part} PRIVATE tactnet_program_parts)
    endforeach()
    if(NOT CMAKE_CXX_COMPILER_LAUNCHER)
        target_precompile_headers(${target}_units REUSE_FROM tactnet_program_methods)
    endif()
    target_link_libraries(${target} PRIVATE tactnet_quick_to_compile)
    set_target_properties(${target} PROPERTIES TACTNET_UNITS "${compiled}")
endfunction()
