# The example of your own networks and sizes, as its header says, and its page in a browser.
#   cmake -Dprogram=FILE -Dfolder=FOLDER [-Dbrowser=FILE] -P experiment.cmake
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
    set(error "${error}" PARENT_SCOPE)
endfunction()

run("${program}" simulate --out touches --per-class 10)
run("${program}" study --data touches --results study --splits 1 --recipes default)
foreach(row IN ITEMS "small_pooling +7 × 13" "small_pooling +11 × 20" "small_striding +9 × 16" "svm-rbf +9 × 16")
    if(NOT out MATCHES "${row}[^\n]* ± ")
        message(FATAL_ERROR "Expected a row of ${row}, found: ${out}")
    endif()
endforeach()
file(READ "${folder}/study/study.md" tables)
foreach(row IN ITEMS "small_pooling .* 7 × 13" "small_pooling .* 11 × 20" "small_striding .* 9 × 16")
    if(NOT tables MATCHES "${row} .[ 0-9]+.[ 0-9]+.\n")
        message(FATAL_ERROR "Expected the bytes of ${row}, found: ${tables}")
    endif()
endforeach()
run("${program}" recommend --results study --rows 9 --columns 16)
if(NOT out MATCHES "experiment::small_(pooling|striding)<tactnet::shape{(9, 16|7, 13)}, 22>\n$")
    message(FATAL_ERROR "Expected the type of a network, found: ${out}")
endif()

file(READ "${folder}/study/study.html" page)
if(NOT browser OR NOT page MATCHES "<svg")
    message(STATUS "The page is not looked at: there is no Chromium, or no gnuplot.")
    return()
endif()
# What the page's script shows: the point under the pointer is described.
string(REPLACE "</body>" "<script>
document.querySelector('[onmousemove]').dispatchEvent(new MouseEvent('mousemove', {clientX: 9, clientY: 9}));
document.title = hint.style.display + ': ' + hint.textContent;
</script></body>" page "${page}")
file(WRITE "${folder}/study/asked.html" "${page}")
run("${browser}" --headless --no-sandbox --disable-gpu --enable-logging=stderr --dump-dom "file://${folder}/study/asked.html")
if(error MATCHES "CONSOLE[^\n]*")
    message(FATAL_ERROR "Expected a page without complaint, found ${CMAKE_MATCH_0}")
endif()
if(NOT out MATCHES "<title>block: [a-z_-]+ [0-9]+x[0-9]+\ndefault recipe\n[0-9.]+ ± [0-9.]+ % over 1 random splits\n")
    string(REGEX MATCH "<title>[^<]*" found "${out}")
    message(FATAL_ERROR "Expected what a point is, found ${found}")
endif()
