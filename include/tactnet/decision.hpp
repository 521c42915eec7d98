#pragma once

#include <tactnet/decision/contact_detector.hpp>
#include <tactnet/decision/discriminant.hpp>
#include <tactnet/decision/fit_discriminant.hpp>
#include <tactnet/decision/fitting.hpp>
#include <tactnet/decision/gain_monitor.hpp>
#include <tactnet/decision/probabilities.hpp>
#include <tactnet/decision/sensor_health.hpp>
#include <tactnet/decision/touch_evidence.hpp>
#include <tactnet/runtime/saved_state.hpp>
