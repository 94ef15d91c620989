// SPDX-License-Identifier: MIT
// Controls for what is cut with and on, and whether it is printed first: the same ones wherever that matters.
import * as outfit from './outfit';
import { Choice, Tick } from './parts';
import { cutter, kByHand, paper, prints } from './preferences';
import { designWords } from './words_design';

const words = designWords.outfit;

export function OutfitChoice({ canPrint = true }: { canPrint?: boolean }) {
  const cutters: [string, string][] = [...outfit.cutters.value, [kByHand, words.byHand]];
  const papers = outfit.papers.value.map((one): [string, string] => [one.name, one.title]);
  const byHand = outfit.chosenCutter.value === kByHand;
  return (
    <div class="outfit">
      <Choice label={words.cutter} value={outfit.chosenCutter.value || (outfit.firstCutter.value?.id ?? '')} options={cutters} onChange={(value) => { cutter.value = value; }} />
      <Choice label={words.paper} value={outfit.chosenPaper.value?.name ?? ''} options={papers} onChange={(value) => { paper.value = value; }} />
      {canPrint && !byHand && outfit.canFindMarks.value && (
        <Tick checked={prints.value === 'yes'} onChange={(on) => { prints.value = on ? 'yes' : 'no'; }}>{words.prints}</Tick>
      )}
    </div>
  );
}
