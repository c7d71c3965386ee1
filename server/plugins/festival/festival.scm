;; SPDX-License-Identifier: GPL-3.0-or-later
;; What Festival is taught when the plugin starts it. A request is one call of faccia.speak; the answer goes
;; to descriptor 3:
;;   p NAME START END STRESS    a segment, seconds
;;   w INDEX START END          a word of the token INDEX, seconds
;;   a COUNT RATE               and then so many samples, 16 bit, native order
;; or "e" when Festival has reported an error, whose text is on its standard error.

(set! faccia.fd "/dev/fd/3")
(defvar hts_engine_params nil) ; Festival's own engine for HTS voices may not be loaded
(set! faccia.voice nil)
(set! faccia.units 1)
(set! faccia.lead 0)
(set! faccia.trail 0)

(set! faccia.token "R:SylStructure.parent.parent.R:Token.parent.") ; from a segment

;; A segment's factor, from its token; pauses have none.
(define (faccia.factor seg name)
  (let ((f (parse-number (item.feat seg (string-append faccia.token name)))))
    (if (> f 0) f 1)))

(define (faccia.silence? seg)
  (member_string (item.name seg) (cadr (assoc 'silences (PhoneSet.description '(silences))))))

;; Durations: each token's factor, and the pauses at both ends as they were asked for.
(define (faccia.stretch utt)
  (let ((before 0) (at 0) end)
    (mapcar
     (lambda (seg)
       (set! end (item.feat seg "end"))
       (set! at
             (+ at
                (cond
                 ((not (faccia.silence? seg)) (* (- end before) (faccia.factor seg "faccia_stretch")))
                 ((not (item.prev seg)) faccia.lead)
                 ((not (item.next seg)) faccia.trail)
                 (t (- end before)))))
       (set! before end)
       (item.set_feat seg "end" at))
     (utt.relation.items utt 'Segment))
    utt))

;; Fundamental frequency: f = m p (f0 / m) ^ r, with the utterance's mean m and the token's factors p and r.
(define (faccia.bend utt)
  (let ((sum 0) (count 0) mean seg)
    (if (member 'Target (utt.relationnames utt))
        (let ((targets (utt.relation.leafs utt 'Target)))
          (mapcar (lambda (x) (set! sum (+ sum (item.feat x "f0"))) (set! count (+ count 1))) targets)
          (if (> sum 0)
              (begin
                (set! mean (/ sum count))
                (mapcar
                 (lambda (x)
                   (set! seg (item.relation.parent x 'Target))
                   (if (and seg (> (item.feat x "f0") 0))
                       (item.set_feat
                        x "f0"
                        (faccia.between
                         40
                         (* mean (faccia.factor seg "faccia_pitch")
                            (exp (* (faccia.factor seg "faccia_range") (log (/ (item.feat x "f0") mean)))))
                         500))))
                 targets)))))
    utt))

(define (faccia.between low x high)
  (cond ((< x low) low) ((> x high) high) (t x)))

(set! faccia.Duration Duration)
(define (Duration utt)
  (faccia.Duration utt)
  (faccia.stretch utt))

(set! faccia.Int_Targets Int_Targets)
(define (Int_Targets utt)
  (faccia.Int_Targets utt)
  (faccia.bend utt))

;; Diphones are added up in 16 bit where they overlap, and wrap round: they are made quieter before. They
;; belong to the voice's database, so it is a copy that is scaled.
(set! faccia.unit_concat us_unit_concat)
(define (us_unit_concat utt)
  (mapcar
   (lambda (unit)
     (let ((wave (wave.copy (item.feat unit "sig"))))
       (wave.rescale wave faccia.units nil)
       (item.set_feat unit "sig" wave)))
   (utt.relation.items utt 'Unit))
  (faccia.unit_concat utt))

(define (faccia.answer utt)
  (let ((out (fopen faccia.fd "w")) (wave (utt.wave utt)) stress)
    (mapcar
     (lambda (seg)
       (set! stress (if (string-equal (item.feat seg "ph_vc") "+")
                       (item.feat seg "R:SylStructure.parent.stress")
                       0))
       (format out "p %s %s %s %s\n" (item.name seg) (item.feat seg "segment_start")
               (item.feat seg "segment_end") stress))
     (utt.relation.items utt 'Segment))
    (mapcar
     (lambda (word)
       (if (item.relation.daughters word 'SylStructure)
           (format out "w %s %s %s\n" (item.feat word "R:Token.parent.faccia_index")
                   (item.feat word "word_start") (item.feat word "word_end"))))
     (utt.relation.items utt 'Word))
    (format out "a %s %s\n" (cadr (assoc 'num_samples (wave.info wave)))
            (cadr (assoc 'sample_rate (wave.info wave))))
    (fclose out)
    (wave.save wave faccia.fd 'raw)))

;; tokens: (TEXT PREPUNCTUATION PUNCTUATION INDEX STRETCH PITCH RANGE) each; hts: what is added to an HTS
;; engine's parameters.
(define (faccia.synthesise voice units lead trail hts tokens)
  (if (not (equal? voice faccia.voice))
      (begin
        (set! faccia.voice nil)
        (eval (list voice))
        (set! faccia.voice voice)
        (set! faccia.hts hts_engine_params)))
  (set! faccia.units units)
  (set! faccia.lead lead)
  (set! faccia.trail trail)
  (set! hts_engine_params (append faccia.hts hts))
  (let ((utt (Utterance Tokens nil)))
    (utt.relation.create utt 'Token)
    (mapcar
     (lambda (token)
       (utt.relation.append
        utt 'Token
        (list (car token)
              (mapcar list
                      '(prepunctuation punc faccia_index faccia_stretch faccia_pitch faccia_range whitespace)
                      (append (cdr token) (list " "))))))
     tokens)
    (utt.synth utt)
    (faccia.answer utt)))

(define (faccia.speak voice units lead trail hts tokens)
  (unwind-protect
   (faccia.synthesise voice units lead trail hts tokens)
   (let ((out (fopen faccia.fd "w")))
     (format out "e\n")
     (fclose out))))
