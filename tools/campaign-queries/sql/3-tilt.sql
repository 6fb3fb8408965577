-- Claim 3: the platform never tilts further than its bound, and not further after a stop than it may while the drives hold.
SELECT kind, encoder,
    count(*) FILTER (tilt_over_bound > 1) AS beyond_bound,
    count(*) FILTER (tilt_hold_mrad > hold_bound_mrad) AS after_stop,
    count(*) AS runs,
    upper_bound(beyond_bound, runs) AS at_most,
    max(bounded_tilt_mrad / limit_mrad) AS tilt_over_limit,
    max(tilt_over_bound) AS tilt_over_bound,
    coalesce(max(tilt_off_mrad / limit_mrad), 0) AS off_over_limit
FROM faulty GROUP BY GROUPING SETS ((kind, encoder), ()) ORDER BY kind, encoder;
