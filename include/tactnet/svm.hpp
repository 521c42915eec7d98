#pragma once

#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/svm/grid_search.hpp>
#include <tactnet/svm/kernel/space.hpp>
#include <tactnet/svm/kernel_machine.hpp>
#include <tactnet/svm/kernel_training.hpp>
#include <tactnet/svm/linear_machine.hpp>

// Support vector machines: kernel and linear machines, probabilities, grid search.
