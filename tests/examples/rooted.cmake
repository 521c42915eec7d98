# A network of one's own with roots and a softmax, through the program in 8 bits: trained, told in both forms, and
# exported as a header that gives the same bits.
#   cmake -Dprogram=FILE -Dfolder=FOLDER -Dcompiler=FILE -Doptions=a,b -Dincludes=a,b -Dsource=FILE -P rooted.cmake
cmake_minimum_required(VERSION 3.22)
file(REMOVE_RECURSE "${folder}")
file(MAKE_DIRECTORY "${folder}")
function(run)
    execute_process(
        COMMAND ${ARGV} WORKING_DIRECTORY "${folder}" RESULT_VARIABLE status OUTPUT_VARIABLE out ERROR_VARIABLE error
    )
    if(NOT status EQUAL 0)
        message(FATAL_ERROR "Expected status 0 of ${ARGV}, found ${status}: ${error}")
    endif()
    set(out "${out}" PARENT_SCOPE)
endfunction()

run("${program}" simulate --out touches --per-class 10)
set(data --data touches)
run("${program}" train ${data} --method roots --rows 7 --columns 13 --resize --epochs 12 --output float.safetensors)
foreach(to IN ITEMS bytes.safetensors roots.hpp)
    run("${program}" export --weights float.safetensors --bits 8 ${data} --resize --namespace rooted --output ${to})
endforeach()
# Two files, one class and nearly one probability: which it would not be of a softmax that is taken twice.
file(GLOB images "${folder}/touches/*/*")
list(SORT images)
list(GET images 0 image)
foreach(form IN ITEMS float bytes)
    run("${program}" classify --weights ${form}.safetensors --resize "${image}")
    if(NOT out MATCHES "[^,]+,([0-9]+,[^,]*),0\\.([0-9][0-9][0-9])[0-9]*\n")
        message(FATAL_ERROR "Expected a class and a probability, found: ${out}")
    endif()
    set(${form}_class "${CMAKE_MATCH_1}")
    set(${form}_share "${CMAKE_MATCH_2}")
    run("${program}" evaluate --weights ${form}.safetensors ${data} --resize)
endforeach()
message(STATUS "${float_class}: 0.${float_share} in single precision, 0.${bytes_share} in 8 bits")
math(EXPR difference "1${float_share} - 1${bytes_share}") # no leading zeros
if(NOT float_class STREQUAL bytes_class OR difference GREATER 15 OR difference LESS -15)
    message(FATAL_ERROR "Expected one class and nearly one probability of both forms")
endif()
if(float_share LESS 150)
    message(FATAL_ERROR "Expected a probability that a softmax taken twice could not give")
endif()

string(REPLACE "," ";" options "${options}")
string(REPLACE "," ";" includes "${includes}")
list(TRANSFORM includes PREPEND "-I")
run("${compiler}" -std=c++20 -O1 -fno-exceptions -fno-rtti ${options} "-I${folder}" ${includes} "${source}" -o firmware)
run("${folder}/firmware")
