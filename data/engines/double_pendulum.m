% SPDX-License-Identifier: Apache-2.0
% The double pendulum of data/scenes/double_pendulum.toml by hand: two uniform rods, q2 relative.
%
%     ./dynwitness crosscheck double_pendulum --engine "octave-cli -q data/engines/double_pendulum.m"
1;
addpath(fileparts(mfilename("fullpath")));

function known = engine(scene)
  g0 = -scene.gravity(3);
  m1 = 1; m2 = 0.8; l1 = 0.5; l2 = 0.4;
  r1 = l1 / 2; r2 = l2 / 2;                          % to the centres of mass
  I1 = m1 * l1 ^ 2 / 12; I2 = m2 * l2 ^ 2 / 12;      % about them
  m22 = I2 + m2 * r2 ^ 2;
  m12 = @(q) m22 + m2 * l1 * r2 * cos(q(2));
  m11 = @(q) I1 + m1 * r1 ^ 2 + m2 * l1 ^ 2 + m22 + 2 * m2 * l1 * r2 * cos(q(2));
  M = @(q) [m11(q), m12(q); m12(q), m22];
  c = @(q, qd) m2 * l1 * r2 * sin(q(2)) * [-(2 * qd(1) + qd(2)) * qd(2); qd(1) ^ 2];
  g = @(q) g0 * [(m1 * r1 + m2 * l1) * sin(q(1)) + m2 * r2 * sin(q(1) + q(2)); m2 * r2 * sin(q(1) + q(2))];
  known.M = @(q, varargin) M(q);
  known.c = @(q, qd, varargin) c(q, qd);
  known.g = @(q, varargin) g(q);
  known.tau = @(q, qd, qdd, varargin) M(q) * qdd + c(q, qd) + g(q);
  known.qdd = @(q, qd, ~, tau) M(q) \ (tau - c(q, qd) - g(q));
  known.kinetic = @(q, qd, varargin) qd' * M(q) * qd / 2;
end

testify(@engine, "double_pendulum_in_octave");
