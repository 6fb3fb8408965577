-- What several queries use: `runs`, and of them `faulty`. With the drives off, the bound on tilt holds only on model levels on which torque
-- does not move the cranks.
CREATE VIEW runs AS
SELECT *,
    greatest(tilt_mrad, CASE WHEN model_level IN ('rigid', 'phased', 'elastic') THEN NULL ELSE tilt_off_mrad END) AS bounded_tilt_mrad,
    bounded_tilt_mrad / nullif(bound_mrad, 0) AS tilt_over_bound
FROM campaign;
CREATE VIEW faulty AS SELECT * FROM runs WHERE kind IS NOT NULL;
CREATE MACRO quantile_of(sorted, part) AS list_extract(sorted, greatest(1, ceil(part::DOUBLE * len(sorted))::BIGINT));
-- Ends of the 95 % interval of a rate (interval.py); of no runs there is none.
CREATE MACRO lower_bound(hits, total) AS lower_end(hits, nullif(total, 0));
CREATE MACRO upper_bound(hits, total) AS upper_end(hits, nullif(total, 0));
