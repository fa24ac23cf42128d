#include "solver/runner/run_state.h"

#include "core/byte_stream.h"
#include "core/scene/scene_fields.h"
#include "solver/hand/hand_fields.h"
#include "solver/world/snapshot_fields.h"

#include <ostream>

namespace springtower {

template <class Stream>
void fieldsOf(Stream& stream, FittedBox& box) {
  auto& [centre, axis, half] = box;
  stream(centre, axis, half);
}

template <class Stream>
void fieldsOf(Stream& stream, Standing& standing) {
  auto& [stands, block, fall, amount] = standing;
  stream(stands, block, fall, amount);
}

template <class Stream>
void fieldsOf(Stream& stream, MoveResult& result) {
  auto& [block, done, rested, moved_m, moved, each_m, statics, settlement_m, slide_m, force_n, begin_s, end_s] = result;
  stream(block, done, rested, moved_m, moved, each_m, statics, settlement_m, slide_m, force_n, begin_s, end_s);
}

template <class Stream>
void fieldsOf(Stream& stream, MoveRun& run) {
  auto& [results, finished, leftOut, laid, rigid, settled_m, phase, phase_s, draw, goal, goalTurn, place, placeTurn, release,
         before, now] = run;
  stream(results, finished, leftOut, laid, rigid, settled_m, phase, phase_s, draw, goal, goalTurn, place, placeTurn, release,
         before, now);
}

template <class Stream>
void fieldsOf(Stream& stream, RunProgress& progress) {
  auto& [moves, reference, laid, standing, fallTime_s] = progress;
  stream(moves, reference, laid, standing, fallTime_s);
}

void writeRun(const SavedRun& run, std::ostream& stream) {
  ByteWriter writer;
  writer(run.scene, run.progress);
  writeSnapshot(*run.snapshot, writer);
  const std::string bytes = sealed(SealKind::run, writer.bytes());
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

LoadedRun readRun(const std::string& path, const std::string& source) {
  const Unsealed file = unsealedFile(SealKind::run, path, source);
  ByteReader reader(file.payload, source);
  LoadedRun loaded;
  SavedRun& run = loaded.run;
  reader(run.scene, run.progress);
  run.snapshot = readSnapshot(reader);
  reader.end();
  checkScene(run.scene, source);
  const std::size_t blocks = run.scene.blocks.size();
  const MoveRun& moves = run.progress.moves;
  const bool fits = run.progress.reference.size() == blocks && moves.leftOut.size() == blocks &&
                    run.progress.laid <= moves.laid.size() && (run.scene.moves.empty() || moves.rigid.size() == blocks);
  if (!fits) reader.refuse("those of others", "moves of the scene's blocks");
  loaded.commit = file.commit;
  return loaded;
}

}  // namespace springtower
