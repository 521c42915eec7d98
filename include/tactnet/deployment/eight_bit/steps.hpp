#pragma once

#include <tactnet/deployment/eight_bit/frame.hpp>
#include <tactnet/deployment/eight_bit/steps/average_pool.hpp>
#include <tactnet/deployment/eight_bit/steps/convolution.hpp>
#include <tactnet/deployment/eight_bit/steps/dense.hpp>
#include <tactnet/deployment/eight_bit/steps/elementwise.hpp>
#include <tactnet/deployment/eight_bit/steps/first.hpp>
#include <tactnet/deployment/eight_bit/steps/pool.hpp>
#include <tactnet/deployment/eight_bit/steps/square_root.hpp>
#include <tactnet/deployment/steps.hpp>
