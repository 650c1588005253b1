// SPDX-License-Identifier: Apache-2.0
// Holds your answers to golden vectors of dynwitness: node verify.mjs GOLDEN.csv ANSWERS.csv [FACTOR]
// (verify.py says what is in these files and what comes out)
import { readFileSync } from "node:fs";

function main(golden, answers, factor = "1") {
  const lines = (file) => readFileSync(file, "utf8").split(/\r?\n/).filter((line) => line !== "");
  const number = (text) => {
    if (text.trim() === "" || (Number.isNaN(Number(text)) && !/^[-+]?nan$/i.test(text.trim()))) throw Error("no number: " + text);
    return Number(text);
  };
  const text = lines(golden), judged = new Map(), wrong = new Map(), sentences = new Map();
  for (const line of text)
    if (line.startsWith("# group ")) {
      const at = line.indexOf(": "), group = line.slice(8, at);
      sentences.set(group, line.slice(at + 2)), judged.set(group, 0), wrong.set(group, []);
    }
  // group,state,role,quantity,row,column,value,digits50,radius,limit
  const wanted = text.filter((line) => line[0] !== "#").map((line) => line.split(",")).filter((x) => x[2] === "wanted");
  const place = (x) => [x[1], x[3], x[4], x[5]].join(",");
  const said = new Map(lines(answers).slice(1).map((line) => line.split(",")).map((x) => [x.slice(0, 4).join(","), x[4] ?? ""]));
  const asked = new Set(wanted.map(place)), unknown = [...said.keys()].filter((key) => !asked.has(key)).sort();
  if (unknown.length || !said.size) throw Error(answers + ": " + (unknown.length ? "not asked for: " + unknown[0] : "no answers"));
  const known = new Set([...said.keys()].map((key) => key.split(",")[1]));
  for (const x of wanted) {
    if (!known.has(x[3]) || x[9] === "") continue;
    judged.set(x[0], judged.get(x[0]) + 1);
    const got = said.get(place(x)) ?? "nan";
    if (!(Math.abs(number(got) - number(x[6])) <= number(x[9]) * number(factor)))
      wrong.get(x[0]).push(`${place(x)}: got ${got}, wanted ${x[6]}, limit ${x[9]}`);
  }
  if (![...judged.values()].some((count) => count)) throw Error("nothing that was answered has a limit");
  for (const [group, bad] of wrong)
    console.log(`${group}: ${bad.length} of ${judged.get(group)} numbers wrong${bad.length ? ", the first " + bad[0] : ""}`);
  for (const quantity of [...new Set(wanted.map((x) => x[3]))].filter((x) => !known.has(x)).sort()) console.log("not answered: " + quantity);
  const failed = [...wrong.keys()].filter((group) => wrong.get(group).length);
  console.log(failed.length ? `first to fail: ${failed[0]}: ${sentences.get(failed[0])}` : "all right");
  return failed.length ? 1 : 0;
}

try {
  process.exitCode = main(...process.argv.slice(2));
} catch (problem) {
  console.error(problem.message);
  process.exitCode = 2;
}
