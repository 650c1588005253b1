% SPDX-License-Identifier: Apache-2.0
% Your Octave functions as a witness of dynwitness (crosscheck/witnesses/engine_protocol.md):
%
%     testify(@engine, "my_arm")
%
% engine(scene) is called once, with what jsondecode() makes of the scene (links are a cell array),
% and returns a structure of functions of q, qd, qdd, tau (columns), among M, c, g, tau, qdd, kinetic,
% potential, momentum. It calls error("refused: why") where it cannot hold the scene. What a function
% throws is the reason why there is no value at that state. double_pendulum.m is an example. Run with
% Octave 7.3.0 (README.md). MATLAB cannot read standard input: README.md, "answers in a file".
function testify(engine, name)
  known = struct();
  while true
    try
      line = input("", "s");    % fgetl() would wait for the first character of the line after this one
    catch
      return;
    end
    asked = jsondecode(line);
    if isfield(asked, "scene")
      said = sprintf("{\"protocol\":1,\"name\":\"%s\",\"version\":\"Octave %s\"", name, version());
      try
        known = engine(asked.scene);
        said = [said, ",\"quantities\":[\"", strjoin(fieldnames(known)', "\",\""), "\"]}"];
      catch problem
        if !strncmp(problem.message, "refused: ", 9)
          rethrow(problem);
        end
        said = sprintf("%s,\"refuses\":%s}", said, jsonencode(problem.message(10:end)));
      end
    else
      states = asked.states;
      answers = cell(1, numel(states));
      for k = 1:numel(states)
        s = states(k);
        parts = cell(1, numel(asked.quantities));
        for i = 1:numel(asked.quantities)
          quantity = asked.quantities{i};
          parts{i} = sprintf("\"%s\":%s", quantity, answer(known.(quantity), quantity, s));
        end
        answers{k} = ["{", strjoin(parts, ","), "}"];
      end
      said = sprintf("{\"batch\":%d,\"answers\":[%s]}", asked.batch, strjoin(answers, ","));
    end
    fputs(stdout, [said, "\n"]);
    fflush(stdout);
  end
end

function text = answer(f, quantity, s)
  try
    value = f(s.q(:), s.qd(:), s.qdd(:), s.tau(:));
    if !all(isfinite(value(:)))
      error("not finite");
    end
    if strcmp(quantity, "M")
      rows = cellfun(@(row) numbers(row), num2cell(value, 2)', "UniformOutput", false);
      text = ["[", strjoin(rows, ","), "]"];
    elseif any(strcmp(quantity, {"kinetic", "potential"}))
      text = sprintf("%.17g", value);
    else
      text = numbers(value);
    end
  catch problem
    text = jsonencode(problem.message);
  end
end

function text = numbers(values)
  text = ["[", strjoin(arrayfun(@(x) sprintf("%.17g", x), values(:)', "UniformOutput", false), ","), "]"];
end
