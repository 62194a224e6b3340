// Steps on their way: the browser keeps each until it is answered, and sends it again under the same id, which counts once.
import { call } from "/elements.js";
import { said } from "/words.js";

const AGAIN = 1000, WITHIN = 60000; // ms between two tries, and of one
const KEPT = "axiscal steps";

function all() {
  return JSON.parse(localStorage.getItem(KEPT) ?? "[]");
}

function keep(steps) {
  localStorage.setItem(KEPT, JSON.stringify(steps));
}

export function unanswered(campaign) {
  return all().filter((step) => step.campaign === campaign);
}

export function enter(campaign, path, body) {
  const step = { campaign, path, body: { ...body, step: crypto.randomUUID() } };
  keep([...all(), step]);
  return step;
}

// The answer to a step, as soon as there is one; tell : what is in the way.
export async function deliver(step, tell) {
  for (;;) {
    try {
      const answer = await call(step.path, step.body, WITHIN);
      if (answer.status !== 403) { // whoever may not come in yet has had no answer
        keep(all().filter((other) => other.body.step !== step.body.step));
        return answer;
      }
    } catch {
      tell(said("No answer yet: what you gave is kept here, and sent until it arrives."));
    }
    await new Promise((resolve) => setTimeout(resolve, AGAIN));
  }
}
