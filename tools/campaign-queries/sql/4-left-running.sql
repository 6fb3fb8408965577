-- Claim 4: once the controller has stopped one axis, no other is moved for more than two ticks.
SELECT kind, encoder,
    count(*) FILTER (left_running) AS were_left,
    count(*) AS runs,
    lower_bound(were_left, runs) AS at_least,
    upper_bound(were_left, runs) AS at_most
FROM faulty GROUP BY GROUPING SETS ((kind, encoder), ()) ORDER BY kind, encoder;
