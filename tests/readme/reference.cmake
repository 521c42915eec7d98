# What a reader of the reference relies on: cmake -DFOLDER=… -P reference.cmake
cmake_minimum_required(VERSION 3.22)

function(expect page what)
    file(READ "${FOLDER}/${page}" text)
    if(NOT text MATCHES "${what}")
        message(SEND_ERROR "${page}: expected '${what}'")
    endif()
endfunction()

expect(index.html "structtactnet_1_1shape.html") # the first page leads to the rooms
expect(structtactnet_1_1shape.html "The size of one sample")
expect(classtactnet_1_1kernel__machine.html "svm/kernel_machine.hpp") # the header to include
expect(examples.html "own_network/main.cpp")
expect(concepttactnet_1_1layer.html "requires")

file(GLOB pages "${FOLDER}/*.html")
foreach(page IN LISTS pages)
    if(page MATCHES "_source.html$|config_8hpp")
        continue()
    endif()
    file(STRINGS "${page}" found REGEX "TACTNET_ARCH::|for_[a-z0-9]+::|tactnet::detail::[a-z_]+ (Struct|Class)")
    if(found)
        message(SEND_ERROR "${page}: a name that should not be there: ${found}")
    endif()
endforeach()

file(GLOB indices "${FOLDER}/search/all_*.js")
set(names "")
foreach(index IN LISTS indices)
    file(READ "${index}" text)
    string(APPEND names "${text}")
endforeach()
foreach(name IN ITEMS conv2d deploy load_model kernel_machine classify_logits any_recording)
    if(NOT names MATCHES "\\['${name}'")
        message(SEND_ERROR "the search does not find ${name}")
    endif()
endforeach()
