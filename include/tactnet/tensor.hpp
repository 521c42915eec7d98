#pragma once

#include <tactnet/tensor/batch.hpp>
#include <tactnet/tensor/shape.hpp>
#include <tactnet/tensor/tensor.hpp>
#include <tactnet/tensor/tensor_view.hpp>
