// SPDX-License-Identifier: GPL-3.0-or-later
// The sweeps on the scalars of the crosscheck: compiled once each (compiled_sweeps_*.cpp), and not
// again in every file that runs them. What is not listed here is compiled where it is used.
#pragma once

#include "recursive/compiled_sweeps.hpp"

namespace dynwitness::crosscheck {

class AdjointError;
class AdjointErrorNumbers;
class Ball;
class BallNumbers;
class FieldNumbers;
class PrimeField;
class RunningError;
class RunningErrorNumbers;

}  // namespace dynwitness::crosscheck

namespace dynwitness::recursive {

DYNWITNESS_SWEEPS(extern, double);
DYNWITNESS_MODELS(extern, double, scene::RealNumbers<double>);
DYNWITNESS_SWEEPS(extern, float);
DYNWITNESS_MODELS(extern, float, scene::RealNumbers<float>);
DYNWITNESS_SWEEPS(extern, long double);
DYNWITNESS_MODELS(extern, long double, scene::RealNumbers<long double>);
DYNWITNESS_SWEEPS(extern, crosscheck::RunningError);
DYNWITNESS_MODELS(extern, crosscheck::RunningError, crosscheck::RunningErrorNumbers);
DYNWITNESS_SWEEPS(extern, crosscheck::AdjointError);
DYNWITNESS_MODELS(extern, crosscheck::AdjointError, crosscheck::AdjointErrorNumbers);
DYNWITNESS_SWEEPS(extern, crosscheck::PrimeField);
DYNWITNESS_MODELS(extern, crosscheck::PrimeField, crosscheck::FieldNumbers);
DYNWITNESS_SWEEPS(extern, crosscheck::Ball);
DYNWITNESS_MODELS(extern, crosscheck::Ball, crosscheck::BallNumbers);

}  // namespace dynwitness::recursive
