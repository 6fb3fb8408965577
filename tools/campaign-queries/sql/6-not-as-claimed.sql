-- Single cases that are not as claimed, or are misnamed, or that no monitor can decide: `cophase campaign --seed SEED --replay NUMBER` runs one again.
SELECT seed, scene, number, clean, kind, encoder, state, verdict, turns_from_limit, reported_faults
FROM runs
WHERE verdict IN ('misnamed', 'missed', 'not-decidable', 'false-trip', 'diverged')
    OR (NOT clean AND (NOT in_time OR left_running OR tilt_over_bound > 1 OR tilt_hold_mrad > hold_bound_mrad))
ORDER BY seed, scene, number, clean;
