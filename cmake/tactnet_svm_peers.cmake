# LIBSVM and LIBLINEAR, which tests and benchmarks of support vector machines compare with where they are found.
find_path(TACTNET_LIBSVM_INCLUDE libsvm/svm.h)
find_library(TACTNET_LIBSVM_LIBRARY svm)
find_path(TACTNET_LIBLINEAR_INCLUDE linear.h)
find_library(TACTNET_LIBLINEAR_LIBRARY linear)
if(TACTNET_LIBSVM_INCLUDE AND TACTNET_LIBSVM_LIBRARY AND TACTNET_LIBLINEAR_INCLUDE AND TACTNET_LIBLINEAR_LIBRARY)
    set(TACTNET_SVM_PEERS TRUE)
else()
    set(TACTNET_SVM_PEERS FALSE)
endif()

# tactnet_use_svm_peers(target): gives it benchmarks/peers/support_vector_machines.hpp.
function(tactnet_use_svm_peers target)
    set(peers "${PROJECT_SOURCE_DIR}/benchmarks/peers")
    target_sources(${target} PRIVATE "${peers}/support_vector_machines.cpp")
    target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}/benchmarks")
    target_include_directories(${target} SYSTEM PRIVATE "${TACTNET_LIBSVM_INCLUDE}" "${TACTNET_LIBLINEAR_INCLUDE}")
    target_link_libraries(${target} PRIVATE "${TACTNET_LIBSVM_LIBRARY}" "${TACTNET_LIBLINEAR_LIBRARY}")
endfunction()
